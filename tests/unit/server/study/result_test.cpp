#include "server/study/result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/study/measure.h"
#include "server/study/page.h"
#include "server/study/pictures.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;
using testing::HasSubstr;

FloatImage evenPicture(float value, float variance = 0, uint32_t width = 8, uint32_t height = 4) {
    FloatImage image{.width = width, .height = height, .channels = {}, .planes = {}};
    for (const std::string channel : {"R", "G", "B"}) {
        image.channels.push_back(channel);
        image.planes.emplace_back(image.pixelCount(), value);
    }
    for (const std::string channel : {"variance.R", "variance.G", "variance.B"}) {
        image.channels.push_back(channel);
        image.planes.emplace_back(image.pixelCount(), variance);
    }
    return image;
}

StudyPlan twoClamps() {
    JobSpec spec;
    spec.scene.files = {{"a.glb", std::string(64, 'a')}};
    spec.scene.entry = "a.glb";
    spec.image = {.width = 8, .height = 4, .tileSize = 8};
    json study{{"job", toJson(spec)}, {"samples", {16}}, {"seeds", 2}};
    study["knobs"] = json::parse(R"([{"path": "settings.clampIndirect", "values": [1, 2]}])");
    return StudyPlan(studyFromJson(study));
}

// A cell whose seeds give these values; the bias stands by itself.
json measuredCell(std::vector<double> errors, std::vector<double> seconds, double squaredBias = 0,
                  double z = 0) {
    const Estimate error = estimateOf(errors);
    return {{"mse", toJson(error)},
            {"deviceSeconds", toJson(estimateOf(seconds))},
            {"variance", error.value - squaredBias},
            {"squaredBias", squaredBias},
            {"bias", {{"value", 0.1 * z}, {"low", 0}, {"high", 0}, {"percent", z}, {"z", z}}},
            {"efficiency", toJson(Estimate{1, 0, 1, 1})},
            {"metrics", json::object()},
            {"perSeed", {{"mse", errors}, {"deviceSeconds", seconds}}}};
}

// Two seeds, 0.1 off to either side of a reference of 1: errors 0.01, no bias, variance 2 · 0.01.
TEST(StudyMeasure, ComparesEachSeedWithTheReference) {
    const std::vector<double> seconds{2, 4};
    const auto cell = measureCell(evenPicture(1), seconds,
                                  [](size_t seed) { return evenPicture(seed == 0 ? 1.1f : 0.9f); });
    EXPECT_NEAR(cell.result["mse"]["value"], 0.01 / 1.0001, 1e-8);
    EXPECT_NEAR(cell.result["variance"], 0.02 / 1.0001, 1e-8);
    EXPECT_NEAR(cell.result["squaredBias"], -0.01 / 1.0001, 1e-8);
    EXPECT_NEAR(cell.result["bias"]["value"], 0, 1e-8);
    EXPECT_EQ(cell.result["deviceSeconds"]["value"], 3);
    EXPECT_NEAR(cell.result["efficiency"]["value"], 100.01 / std::sqrt(8.0), 1e-3);  // of 100/2 and 100/4
    EXPECT_NEAR(cell.result["metrics"]["rmse"]["value"], 0.1, 1e-6);
    EXPECT_THAT(cell.pictures["difference"], HasSubstr("data:image/png;base64,iVBOR"));
}

// What is as exact as the reference has an error of about 0, on either side of it.
TEST(StudyResult, SeesNoBiasInTheReferencesOwnNoise) {
    std::map<uint32_t, json> measured;
    for (uint32_t cell = 0; cell < 3; ++cell) measured[cell] = measuredCell({-1e-6, -3e-6}, {1, 1}, -5e-7);
    const json result = studyResult(twoClamps(), measured);
    for (const json& variant : result["variants"]) EXPECT_EQ(variant["cells"][0]["biased"], false);
    measured[1] = measuredCell({1e-6, 3e-6}, {1, 1}, 1.5e-6);
    EXPECT_EQ(studyResult(twoClamps(), measured)["variants"][1]["cells"][0]["biased"], true);
}

TEST(StudyMeasure, TellsABiasByItsZ) {
    const std::vector<double> seconds{1, 1};
    const auto cell =
        measureCell(evenPicture(1, 0.0096f), seconds,  // variance of the mean 0.0096 / 96 = 0.01²
                    [](size_t) { return evenPicture(0.95f); });
    EXPECT_NEAR(cell.result["bias"]["percent"], -5, 1e-4);
    EXPECT_NEAR(cell.result["bias"]["z"], -5, 1e-3);
    EXPECT_NEAR(cell.result["referenceVariance"], 0.0096 / 1.0001, 1e-6);
}

TEST(StudyResult, SetsEachVariantAgainstTheBase) {
    const json base = measuredCell({0.4, 0.4}, {1, 1}), better = measuredCell({0.1, 0.1}, {2, 2}, 0.02);
    const json result = studyResult(twoClamps(), {{0, base}, {1, better}});
    const json& cell = result["variants"][1]["cells"][0];
    EXPECT_NEAR(cell["errorRatio"]["value"], 4, 1e-9);
    EXPECT_NEAR(cell["efficiencyRatio"]["value"], 2, 1e-9);
    EXPECT_NEAR(cell["atBaseSeconds"]["mse"], 0.02 + 0.08 * 2, 1e-9);  // half the samples, twice the variance
    EXPECT_EQ(cell["pareto"], true);
    EXPECT_EQ(result["variants"][2]["cells"], json::array());
    EXPECT_TRUE(result["verdict"].is_null());  // not whole
}

TEST(StudyResult, NamesWhatIsWorthItsTimeAndItsPrice) {
    const json base = measuredCell({0.4, 0.42}, {1, 1});
    const auto verdictOf = [&](const json& one, const json& two) {
        return studyResult(twoClamps(), {{0, base}, {1, one}, {2, two}})["verdict"].get<std::string>();
    };
    const json strong = measuredCell({0.04, 0.042}, {1, 1}, 0.03, -9),
               fair = measuredCell({0.1, 0.105}, {1, 1});
    const json worse = measuredCell({0.8, 0.84}, {1, 1});
    EXPECT_THAT(verdictOf(strong, fair), HasSubstr("clampIndirect = 1 is worth its time: 10 times"));
    EXPECT_THAT(verdictOf(strong, fair), HasSubstr("mean is 9 % too dark (z = -9.0)"));
    EXPECT_THAT(verdictOf(strong, fair),
                HasSubstr("Without bias, settings.clampIndirect = 2 is worth its time: 4.00"));
    EXPECT_THAT(verdictOf(strong, worse), HasSubstr("Nothing without bias is worth its time."));
    EXPECT_THAT(verdictOf(worse, base), HasSubstr("No setting is worth its time"));
    EXPECT_THAT(verdictOf(worse, base), HasSubstr("Not worth it: settings.clampIndirect = 1 (0.50 times)"));
}

TEST(StudyResult, WritesALinePerCell) {
    const json base = measuredCell({0.4, 0.4}, {1, 1});
    const std::string csv = studyCsv(studyResult(twoClamps(), {{0, base}, {1, base}}));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
    EXPECT_THAT(csv, HasSubstr("\r\n\"settings.clampIndirect = 1\",16,1.0,0.4,"));
}

TEST(StudyPictures, AreResizedByAreaWithTheirVariance) {
    FloatImage image = evenPicture(1, 0.4f, 4, 2);
    image.planes[0] = {1, 3, 5, 7, 1, 3, 5, 7};
    const FloatImage half = resized(image, 2, 1);
    EXPECT_EQ(half.planes[0], (std::vector<float>{2, 6}));
    EXPECT_FLOAT_EQ(half.planes[3][0], 0.1f);  // of the mean of four
    EXPECT_EQ(resized(half, 4, 2).planes[0], (std::vector<float>{2, 2, 6, 6, 2, 2, 6, 6}));
    EXPECT_EQ(resized(image, 3, 2).planes[0][0],
              (1 + 3.0f / 3) / (4.0f / 3));  // all of one, a third of the next
}

TEST(StudyPictures, ShowTheDenoisedOneWhereThereIsOne) {
    FloatImage image = evenPicture(1, 0.5f);
    for (const std::string channel : {"denoised.R", "denoised.G", "denoised.B"}) {
        image.channels.push_back(channel);
        image.planes.emplace_back(image.pixelCount(), 2.0f);
    }
    EXPECT_EQ(studiedPicture(image, true).plane("R")[0], 2);
    EXPECT_EQ(studiedPicture(image, true).channels.size(), 3u);
    EXPECT_EQ(studiedPicture(image, false).plane("variance.B")[0], 0.5f);
}

TEST(StudyPage, HoldsItsDataWhereNoTextCanEndTheScript) {
    const json view{{"name", "</script><b>"}, {"request", {{"job", {{"scene", "large"}}}}}};
    const std::string page = studyPage(view, {{"reference", "data:"}});
    EXPECT_THAT(page, HasSubstr(R"("name":"\u003c/script>\u003cb>")"));
    EXPECT_THAT(page, testing::Not(HasSubstr("large")));
    EXPECT_THAT(page, HasSubstr("Chart.js v"));
    EXPECT_THAT(page, testing::Not(HasSubstr("/*study*/")));
    EXPECT_THAT(page, testing::Not(HasSubstr("src=\"http")));
}

}  // namespace
}  // namespace tilefarm
