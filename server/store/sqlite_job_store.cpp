#include "server/store/sqlite_job_store.h"

#include <sqlite3.h>

#include <condition_variable>
#include <mutex>
#include <vector>

#include "server/store/sqlite_connection.h"
#include "server/store/sqlite_schema.h"
#include "server/store/sqlite_tables.h"
#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr size_t kReaders = 8;

// A connection with its tables. `connection` is declared first so that it outlives the statements' users.
struct Session {
    Connection connection;
    SqliteTables tables;
    Session(const std::string& file, bool writer) : connection(file, writer), tables(connection) {}
};

[[noreturn]] void rethrow(const SQLite::Exception& fault, const std::string& file) {
    const std::string message = "database '" + file + "': " + fault.what();
    switch (fault.getErrorCode()) {
        case SQLITE_FULL: throw Error(ErrorCode::outOfSpace, message);
        case SQLITE_CONSTRAINT: throw Error(ErrorCode::conflict, message);
        default: throw Error(ErrorCode::internal, message);
    }
}

}  // namespace

struct SqliteJobStore::Impl {
    std::string file;
    std::mutex writing;
    std::unique_ptr<Session> writer;

    mutable std::mutex mutex;
    mutable std::condition_variable returned;
    mutable std::vector<std::unique_ptr<Session>> idle;
    mutable size_t readers = 0;

    std::unique_ptr<Session> takeReader() const {
        std::unique_lock lock(mutex);
        returned.wait(lock, [&] { return !idle.empty() || readers < kReaders; });
        if (!idle.empty()) {
            auto session = std::move(idle.back());
            idle.pop_back();
            return session;
        }
        auto session = std::make_unique<Session>(file, false);
        ++readers;
        return session;
    }
    void giveBack(std::unique_ptr<Session> session) const {
        const std::scoped_lock lock(mutex);
        idle.push_back(std::move(session));
        returned.notify_one();
    }
};

SqliteJobStore::SqliteJobStore(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
    impl_->file = file.string();
    try {
        impl_->writer = std::make_unique<Session>(impl_->file, true);
        migrate(impl_->writer->connection.db());
    } catch (const SQLite::Exception& fault) {
        rethrow(fault, impl_->file);
    }
}

// Readers close first, so that the writer is the one that checkpoints at the end.
SqliteJobStore::~SqliteJobStore() {
    impl_->idle.clear();
}

void SqliteJobStore::write(const std::function<void(Tables&)>& work) {
    const std::scoped_lock lock(impl_->writing);
    try {
        SQLite::Transaction transaction(impl_->writer->connection.db(),
                                        SQLite::TransactionBehavior::IMMEDIATE);
        auto tables = impl_->writer->tables.tables();
        work(tables);
        transaction.commit();
    } catch (const SQLite::Exception& fault) {
        rethrow(fault, impl_->file);
    }
}

void SqliteJobStore::read(const std::function<void(const ConstTables&)>& work) const {
    try {
        auto session = impl_->takeReader();
        struct Return {
            const Impl& impl;
            std::unique_ptr<Session>& session;
            ~Return() { impl.giveBack(std::move(session)); }
        } const back{*impl_, session};
        SQLite::Transaction view(session->connection.db(), SQLite::TransactionBehavior::DEFERRED);
        work(ConstTables(session->tables.tables()));
        view.commit();
    } catch (const SQLite::Exception& fault) {
        rethrow(fault, impl_->file);
    }
}

}  // namespace tilefarm
