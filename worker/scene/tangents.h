#pragma once

#include "worker/scene/scene.h"

namespace tilefarm {

/// Gives a mesh with normals the tangents that `normalTexture` asks for (none: along u of set 0). Vertices whose corners differ are
/// split. Texture coordinates are taken as the texture is read, transform included; v points down in glTF,
/// and the bitangent up in the image.
void generateTangents(Mesh& mesh, const TextureRef& normalTexture);

/// Makes the tangents that a file gave unit length and orthogonal to the normals, and their handedness +1
/// or -1; what is zero or not finite becomes some direction orthogonal to the normal.
void repairTangents(Mesh& mesh);

}  // namespace tilefarm
