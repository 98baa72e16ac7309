#!/usr/bin/env bash
# How Blender 3.4.1 (Debian 12: 3.4.1+dfsg-2+b1) reads multilayer EXRs whose channels are named in valid ways:
#   1. a layer of two channels (uv.U, uv.V) is a socket that carries no picture: a constant. With a third channel it is read;
#   2. what stands before the last two names is a layer of its own: diffuse.direct.R is pass "direct" of layer "diffuse",
#      beside which the passes of the layer without a name are not shown, and the other way round;
#   3. a channel of one long word ("samples") is passed over.
# Files come from oiiotool, which reads all of them right. Exits 0 while this is so.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

command -v blender >/dev/null && command -v oiiotool >/dev/null ||
    apt-get install -qy --no-install-recommends blender=3.4.1+dfsg-2+b1 openimageio-tools=2.4.7.1+dfsg-2
blender --version | head -n 1

names=R,G,B,samples,count.X,two.U,two.V,three.U,three.V,three.A,diffuse.direct.R,diffuse.direct.G,diffuse.direct.B
names+=,flat_direct.R,flat_direct.G,flat_direct.B
count=$(tr , '\n' <<<"$names" | wc -l)
ramp=$(seq -s, 1 "$count")
oiiotool --pattern "fill:left=$ramp:right=${ramp//,/0,}0" 16x8 "$count" --chnames "$names" -d float -o in.exr

cat > passes.py <<'PYTHON'
import bpy
scene = bpy.context.scene
scene.use_nodes = True
nodes, links = scene.node_tree.nodes, scene.node_tree.links
nodes.clear()
image = nodes.new("CompositorNodeImage")
image.image = bpy.data.images.load("in.exr")
writer = nodes.new("CompositorNodeOutputFile")
writer.base_path, writer.format.file_format, writer.format.color_depth = "out", "OPEN_EXR", "32"
writer.file_slots.clear()
for socket in image.outputs:
    writer.file_slots.new(socket.name)
    links.new(socket, writer.inputs[socket.name])
links.new(image.outputs[0], nodes.new("CompositorNodeComposite").inputs[0])
bpy.ops.render.render()
print("PASSES", *(socket.name for socket in image.outputs))
PYTHON
blender -b --factory-startup -P passes.py > log 2>&1
passes=$(sed -n 's/^PASSES //p' log)
echo "passes: $passes"
echo "pictures: $(cd out && echo *)"

offered() { grep -qw "$1" <<<"$passes"; }
written() { [ -e "out/${1}0001.exr" ]; }
grep -q 'unknown channel token: samples' log
! offered samples && ! offered direct
offered two && ! written two
for pass in Combined count three flat_direct; do offered "$pass" && written "$pass"; done
