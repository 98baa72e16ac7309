"""Run by Blender: writes every pass of EXRs that its compositor's Image node offers as an EXR of its own.

    blender -b --factory-startup -P blender_passes.py -- OUT FILE…   makes OUT/STEM/PASS0001.exr
"""
import pathlib
import sys

import bpy

out, *files = map(pathlib.Path, sys.argv[sys.argv.index("--") + 1:])
scene = bpy.context.scene
scene.use_nodes = True
nodes, links = scene.node_tree.nodes, scene.node_tree.links
scene.render.resolution_percentage = 100

for file in files:
    nodes.clear()
    image = nodes.new("CompositorNodeImage")
    image.image = bpy.data.images.load(str(file))
    writer = nodes.new("CompositorNodeOutputFile")
    writer.base_path = str(out / file.stem)
    writer.format.file_format, writer.format.color_depth = "OPEN_EXR", "32"
    writer.file_slots.clear()
    for socket in image.outputs:
        writer.file_slots.new(socket.name)
        links.new(socket, writer.inputs[socket.name])
    links.new(image.outputs[0], nodes.new("CompositorNodeComposite").inputs[0])
    bpy.ops.render.render()
