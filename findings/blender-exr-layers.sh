#!/usr/bin/env bash
# Blender passes over channels of valid EXRs by how they are named and counted.
#
# Expected: every channel of a multilayer EXR can be reached from the compositor's Image node.
# Seen: a layer of two channels (two.U, two.V) has a socket that carries a constant; with a third one it is read.
#   diffuse.direct.R is the pass "direct" of a layer "diffuse", so that it is not among the passes beside R, G and B.
#   A channel of one word ("samples") is passed over with a line on the terminal.
# Matters to: whoever writes EXRs for compositing: LAYER.CHANNEL with one dot, and one, three or four channels.
# Versions: Debian 12, blender 3.4.1+dfsg-2+b1, openimageio-tools 2.4.7.1+dfsg-2. Seen 2026-11-30.
set -euo pipefail
export LC_ALL=C
fail() { echo "CHANGED: $*" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

if ! command -v blender >/dev/null || ! command -v oiiotool >/dev/null; then
    apt-get -qq update
    apt-get -qq install -y --no-install-recommends blender=3.4.1+dfsg-2+b1 openimageio-tools=2.4.7.1+dfsg-2 >/dev/null
fi
dpkg-query -W blender openimageio-tools

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
grep -q 'unknown channel token: samples' log || fail "samples is read"
if offered samples || offered direct; then fail "all layers are offered at once"; fi
if ! offered two || written two; then fail "two channels are read"; fi
for pass in Combined count three flat_direct; do
    offered "$pass" && written "$pass" || fail "$pass is not read"
done
