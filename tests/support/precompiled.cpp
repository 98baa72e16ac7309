// Compiled for the header that comes with it: see tests/CMakeLists.txt.
int main() {}
