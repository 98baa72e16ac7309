#pragma once

#include "tests/support/gltf_builder.h"

namespace tilefarm {

/// A file with most of what the loader knows, EXT_meshopt_compression included.
GltfBuilder seedFile();
/// A square whose primitive is compressed with KHR_draco_mesh_compression; by edgebreaker, or face by face.
GltfBuilder dracoFile(bool edgebreaker);

}  // namespace tilefarm
