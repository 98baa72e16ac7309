#include "worker/scene/accessors.h"

#include <gmock/gmock.h>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Reads accessors of a built file.
struct AccessorsTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder;

    template <typename Read>
    auto with(Read read) {
        const GltfFile file(builder.writeGltf(folder.path()));
        BufferViews views(file);
        Accessors accessors(file.root(), views);
        return read(accessors);
    }
    std::vector<float> scalars(uint32_t index) {
        return with([index](Accessors& a) { return a.scalars(index); });
    }
};

TEST_F(AccessorsTest, NormalisesEveryIntegerTypeAsTheSpecificationSays) {
    builder.accessor(std::vector<int8_t>{-128, -127, 0, 127}, "SCALAR", true);
    builder.accessor(std::vector<uint8_t>{0, 51, 255}, "SCALAR", true);
    builder.accessor(std::vector<int16_t>{-32768, -32767, 0, 32767}, "SCALAR", true);
    builder.accessor(std::vector<uint16_t>{0, 13107, 65535}, "SCALAR", true);
    builder.accessor(std::vector<uint32_t>{0, 4294967295u}, "SCALAR", true);
    EXPECT_THAT(scalars(0), ElementsAre(-1, -1, 0, 1));
    EXPECT_THAT(scalars(1), ElementsAre(0, 0.2f, 1));
    EXPECT_THAT(scalars(2), ElementsAre(-1, -1, 0, 1));
    EXPECT_THAT(scalars(3), ElementsAre(0, 0.2f, 1));
    EXPECT_THAT(scalars(4), ElementsAre(0, 1));
}

TEST_F(AccessorsTest, KeepsIntegersThatAreNotNormalised) {
    builder.accessor(std::vector<int16_t>{-300, 300}, "SCALAR");
    EXPECT_THAT(scalars(0), ElementsAre(-300, 300));
}

TEST_F(AccessorsTest, ReadsInterleavedViews) {
    const std::vector<float> data{1, 2, 3, 10, 20, 4, 5, 6, 30, 40};
    const uint32_t view = builder.view(std::as_bytes(std::span(data)), 20);
    builder.accessorOf(view, "VEC3", 5126, 2);
    builder.accessorOf(view, "VEC2", 5126, 2);
    builder.set("/accessors/1/byteOffset", 12);
    EXPECT_THAT(with([](Accessors& a) { return a.vec3s(0); }),
                ElementsAre(glm::vec3(1, 2, 3), glm::vec3(4, 5, 6)));
    EXPECT_THAT(with([](Accessors& a) { return a.vec2s(1); }),
                ElementsAre(glm::vec2(10, 20), glm::vec2(30, 40)));
}

TEST_F(AccessorsTest, ReadsIndicesOfEveryType) {
    builder.accessor(std::vector<uint8_t>{0, 200}, "SCALAR");
    builder.accessor(std::vector<uint16_t>{0, 60000}, "SCALAR");
    builder.accessor(std::vector<uint32_t>{0, 3000000000u}, "SCALAR");
    builder.accessor(std::vector<int16_t>{0, 1}, "SCALAR");
    EXPECT_THAT(with([](Accessors& a) { return a.integers(0); }), ElementsAre(0, 200));
    EXPECT_THAT(with([](Accessors& a) { return a.integers(1); }), ElementsAre(0, 60000));
    EXPECT_THAT(with([](Accessors& a) { return a.integers(2); }), ElementsAre(0, 3000000000u));
    EXPECT_EQ(codeOf([&] { with([](Accessors& a) { return a.integers(3); }); }), ErrorCode::invalidArgument);
}

struct SparseTest : AccessorsTest {
    /// Accessor 0: four scalars 1 2 3 4 (or zeros) with elements 1 and 3 replaced by 20 and 40.
    void build(std::vector<uint8_t> indices, bool backed) {
        builder.accessor(std::vector<float>{1, 2, 3, 4}, "SCALAR");
        const uint32_t at = builder.view(std::as_bytes(std::span(indices)));
        const std::vector<float> values{20, 40};
        const uint32_t by = builder.view(std::as_bytes(std::span(values)));
        builder.set("/accessors/0/sparse/count", 2);
        builder.set("/accessors/0/sparse/indices", R"({"componentType": 5121})");
        builder.set("/accessors/0/sparse/indices/bufferView", at);
        builder.set("/accessors/0/sparse/values/bufferView", by);
        if (!backed) {
            builder.erase("/accessors/0/bufferView");
        }
    }
};

TEST_F(SparseTest, ReplacesElementsOfAView) {
    build({1, 3}, true);
    EXPECT_THAT(scalars(0), ElementsAre(1, 20, 3, 40));
}

TEST_F(SparseTest, ReplacesZerosWithoutAView) {
    build({1, 3}, false);
    EXPECT_THAT(scalars(0), ElementsAre(0, 20, 0, 40));
}

TEST_F(SparseTest, RefusesIndicesOutOfOrderOrRange) {
    for (const auto& indices : {std::vector<uint8_t>{3, 1}, {1, 1}, {1, 4}}) {
        builder = GltfBuilder();
        build(indices, true);
        const Error error = errorOf([&] { scalars(0); });
        EXPECT_THAT(error.what(), HasSubstr("/accessors/0/sparse/indices: element 1 is"));
    }
}

TEST_F(SparseTest, ChecksItsRanges) {
    build({1, 3}, true);
    builder.set("/accessors/0/sparse/count", 3);
    EXPECT_THAT(errorOf([&] { scalars(0); }).what(),
                HasSubstr("/accessors/0/sparse/indices: its 3 elements"));
    builder.set("/accessors/0/sparse/count", 5);
    EXPECT_THAT(errorOf([&] { scalars(0); }).what(), HasSubstr("/accessors/0/sparse/count: must be"));
}

TEST_F(AccessorsTest, RefusesHugeAccessorsThatNothingBacks) {
    builder.set("/accessors/0", R"({"type": "VEC4", "componentType": 5126, "count": 2000000000})");
    EXPECT_THAT(errorOf([&] { with([](Accessors& a) { return a.vec4s(0); }); }).what(),
                HasSubstr("/accessors/0: with it, 32000000000 bytes of zeros"));
}

TEST_F(AccessorsTest, RefusesManyLargeAccessorsThatNothingBacksTogether) {
    builder.set("/accessors/0", R"({"type": "SCALAR", "componentType": 5125, "count": 12500000})");
    with([](Accessors& a) {
        for (int i = 0; i < 5; ++i) EXPECT_EQ(a.integers(0).size(), 12500000u);
        EXPECT_THAT(errorOf([&] { a.integers(0); }).what(), HasSubstr("no buffer view backs"));
        a.beginPose();
        EXPECT_EQ(a.integers(0).size(), 12500000u);
        return 0;
    });
}

TEST_F(AccessorsTest, PadsMatrixColumnsToFourBytes) {
    builder.accessor(std::vector<uint8_t>(24), "SCALAR");
    builder.set("/accessors/0", R"({"bufferView": 0, "type": "MAT3", "componentType": 5121, "count": 2})");
    EXPECT_EQ(with([](Accessors& a) { return a[0].elementBytes; }), 12u);
}

}  // namespace
}  // namespace tilefarm
