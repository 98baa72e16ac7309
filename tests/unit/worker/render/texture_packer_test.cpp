#include "worker/render/texture_packer.h"

#include <gtest/gtest.h>

namespace tilefarm {
namespace {

Scene twoImages() {
    Scene scene;
    scene.images.push_back({"bytes", 2, 1, {1, 2, 3, 4, 5, 6, 7, 8}, {}});
    scene.images.push_back({"floats", 1, 1, {}, {0.5f, 1, 2, 1}});
    return scene;
}

TEST(TexturePacker, GivesNoIndexForNoTexture) {
    const Scene scene = twoImages();
    TexturePacker packer(scene);
    EXPECT_EQ(packer.add({}), gpu::NO_INDEX);
    EXPECT_TRUE(packer.records.empty());
}

TEST(TexturePacker, StoresAnImageOnceAndARecordPerWayOfReadingIt) {
    const Scene scene = twoImages();
    TexturePacker packer(scene);
    TextureRef ref;
    ref.image = 0;
    const uint32_t linear = packer.add(ref);
    ref.srgb = true;
    const uint32_t srgb = packer.add(ref);
    EXPECT_NE(linear, srgb);
    EXPECT_EQ(packer.add(ref), srgb);
    EXPECT_EQ(packer.texels8, scene.images[0].rgba8);
    EXPECT_EQ(packer.records[srgb].flags & gpu::TEXTURE_SRGB, gpu::TEXTURE_SRGB);
}

TEST(TexturePacker, KeepsFloatTexelsApartAndSaysSo) {
    const Scene scene = twoImages();
    TexturePacker packer(scene);
    TextureRef ref;
    ref.image = 1;
    packer.add(ref);
    EXPECT_EQ(packer.texels32, scene.images[1].rgbaFloat);
    EXPECT_EQ(packer.features, gpu::bit(gpu::FEATURE_FLOAT_TEXTURES));
}

TEST(TexturePacker, CallsForTransformsOnlyWhereThereIsOne) {
    const Scene scene = twoImages();
    TexturePacker packer(scene);
    TextureRef ref;
    ref.image = 0;
    packer.add(ref);
    EXPECT_EQ(packer.features, 0u);
    ref.transform = glm::mat3x2(2, 0, 0, 2, 0.5f, 0);
    ref.uvSet = 1;
    ref.linearFilter = false;
    packer.add(ref);
    EXPECT_EQ(packer.features, gpu::bit(gpu::FEATURE_TEXTURE_TRANSFORMS) |
                                   gpu::bit(gpu::FEATURE_SECOND_UV_SET) |
                                   gpu::bit(gpu::FEATURE_NEAREST_FILTER));
}

}  // namespace
}  // namespace tilefarm
