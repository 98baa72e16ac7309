#pragma once

#include <memory>

#include "server/store/job_store.h"

namespace tilefarm {

class Connection;

/// The tables of JobStore over one connection. The statements are in server/store/sql, a file for each.
class SqliteTables {
public:
    explicit SqliteTables(Connection& connection);
    ~SqliteTables();
    Tables tables();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
