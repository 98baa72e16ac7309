#pragma once

#include <span>

#include "server/store/sqlite_values.h"

namespace tilefarm {

/// A column and where a row keeps it. The parameter `:<name>` of a statement takes the same value.
template <typename Row>
struct Column {
    const char* name;
    void (*read)(const SQLite::Column& from, Row& to);
    void (*bind)(const Row& from, SQLite::Statement& to, int parameter);
};

/// The columns of which a row is made, in no order that matters: statements name what they give and take.
template <typename Row>
std::span<const Column<Row>> columnsOf();

template <>
std::span<const Column<JobRow>> columnsOf();
template <>
std::span<const Column<FrameRow>> columnsOf();
template <>
std::span<const Column<TileRow>> columnsOf();
template <>
std::span<const Column<TileErrorRow>> columnsOf();
template <>
std::span<const Column<LevelRow>> columnsOf();
template <>
std::span<const Column<PassRow>> columnsOf();
template <>
std::span<const Column<LeasedPass>> columnsOf();
template <>
std::span<const Column<LeaseRow>> columnsOf();
template <>
std::span<const Column<DeadlyPass>> columnsOf();
template <>
std::span<const Column<FailureRow>> columnsOf();
template <>
std::span<const Column<WorkerRow>> columnsOf();
template <>
std::span<const Column<ContributionRow>> columnsOf();
template <>
std::span<const Column<ReportRow>> columnsOf();
template <>
std::span<const Column<EventRow>> columnsOf();
template <>
std::span<const Column<StudyRow>> columnsOf();
template <>
std::span<const Column<StudyCellRow>> columnsOf();

}  // namespace tilefarm
