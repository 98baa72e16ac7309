add_executable(tilefarm_trace_bench trace_bench.cpp)
target_link_libraries(tilefarm_trace_bench PRIVATE tilefarm_options tilefarm_ray_support CLI11::CLI11 fmt::fmt)
