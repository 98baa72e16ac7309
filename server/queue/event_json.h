#pragma once

#include <string>

#include "server/store/rows.h"

namespace tilefarm {

/// The data of events, as the event stream and polling show it.
std::string jobStateJson(const JobRow& job);
std::string progressJson(const JobRow& job, const FrameRow& frame);
std::string frameStateJson(const FrameRow& frame);
std::string leaseJson(const std::string& worker, LeaseState state);
std::string workerJson(const WorkerRow& worker);

}  // namespace tilefarm
