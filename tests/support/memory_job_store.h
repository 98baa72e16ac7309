#pragma once

#include <memory>
#include <mutex>

#include "server/store/job_store.h"

namespace tilefarm {

/// Rows in memory, for tests: a transaction works on a copy of everything.
class MemoryJobStore : public JobStore {
public:
    MemoryJobStore();
    ~MemoryJobStore() override;
    void write(const std::function<void(Tables&)>& work) override;
    void read(const std::function<void(const ConstTables&)>& work) const override;

private:
    struct State;
    std::mutex writing_;
    mutable std::mutex mutex_;  // guards state_
    std::shared_ptr<const State> state_;
};

}  // namespace tilefarm
