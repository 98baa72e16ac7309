#pragma once

#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>

namespace tilefarm {

struct JobSpec;

/// The places ("/images/3/uri", "/buffers/0/uri") of files that a render of this glTF may read: through
/// the meshes, skins and materials of its default scene, under the job's variant, and the animations that the
/// job plays. What something else stands in for, a factor of 0 hides or nothing renders is not among them; of
/// a scene without nodes all is. Malformed parts lead nowhere.
std::set<std::string> neededFiles(const nlohmann::json& gltf, const JobSpec& job);

}  // namespace tilefarm
