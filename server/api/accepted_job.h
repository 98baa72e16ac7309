#pragma once

#include "shared/job/job.h"

namespace tilefarm {

struct Services;

/// A job that was sent, with the size that it left open. Throws Error(unprocessable) that names the files of
/// its scene that are not on the server, or tiles that a row of does not fit into memory.
JobSpec acceptedJob(const Services& s, JobSpec spec);
/// The last of these alone.
void requireModestTiles(const ImageSpec& image);

}  // namespace tilefarm
