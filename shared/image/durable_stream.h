#pragma once

// For sources that write with OpenEXR.

#include <OpenEXR/ImfIO.h>

#include <string>

#include "shared/file/durable_file.h"

namespace tilefarm {

/// An OpenEXR stream into a DurableFile. OpenEXR's destructors swallow faults; the file remembers them for
/// commit().
class DurableStream : public Imf::OStream {
public:
    DurableStream(DurableFile& file, const std::string& name) : OStream(name.c_str()), file_(file) {}
    void write(const char bytes[], int n) override {
        file_.write(std::string_view(bytes, static_cast<size_t>(n)));
    }
    uint64_t tellp() override { return file_.position(); }
    void seekp(uint64_t position) override { file_.seek(position); }

private:
    DurableFile& file_;
};

}  // namespace tilefarm
