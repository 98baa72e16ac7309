#include "shared/job/wire.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

const std::string kDigest(64, 'a');

json goodJob() {
    return {
        {"scene", {{"entry", "a.glb"}, {"files", {{"a.glb", kDigest}, {"sky.hdr", std::string(64, 'b')}}}}}};
}

std::vector<std::string> faultsOf(const json& source) {
    const Error error = errorOf([&] { jobFromJson(source); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    std::vector<std::string> pointers;
    for (const Fault& fault : error.faults) pointers.push_back(fault.pointer);
    return pointers;
}

// The good job with `patch` laid over it (RFC 7396).
std::vector<std::string> faultsOfPatch(const char* patch) {
    json job = goodJob();
    job.merge_patch(json::parse(patch));
    return faultsOf(job);
}

TEST(JobFromJson, TakesAJobThatSaysOnlyItsScene) {
    const JobSpec spec = jobFromJson(goodJob());
    JobSpec expected;
    expected.scene.entry = "a.glb";
    expected.scene.files = {{"a.glb", kDigest}, {"sky.hdr", std::string(64, 'b')}};
    expected.stop.samples = 64;
    EXPECT_EQ(spec, expected);
}

TEST(JobFromJson, AJobThatEndsOnAConditionMayTakeMoreSamples) {
    const auto samplesOf = [](const char* stop) {
        json job = goodJob();
        job["stop"] = json::parse(stop);
        return jobFromJson(job).stop.samples;
    };
    EXPECT_EQ(samplesOf("{}"), 64u);
    EXPECT_EQ(samplesOf(R"({"minSamples": 4})"), 64u);
    EXPECT_EQ(samplesOf(R"({"relativeError": 0.05})"), 65536u);
    EXPECT_EQ(samplesOf(R"({"wallSeconds": 60})"), 65536u);
    EXPECT_EQ(samplesOf(R"({"relativeError": 0.05, "samples": 100})"), 100u);
}

TEST(JobFromJson, TakesBackWhatToJsonWrites) {
    JobSpec spec;
    spec.name = "Küche";
    spec.scene = {"dir/a.GLTF", {{"dir/a.GLTF", kDigest}, {"x y/ü.EXR", kDigest}}, "x y/ü.EXR"};
    spec.camera = "Camera.001";
    spec.frames = {-5, 100};
    spec.image = {32768, 1, 256};
    spec.settings.seed = 4294967295u;
    spec.settings.maxBounces = 0;
    spec.settings.rouletteStart = 1024;
    spec.settings.lightSelection = LightSelection::tree;
    spec.settings.integrator = Integrator::whitted;
    spec.settings.aoDistance = 2.5;
    spec.settings.directLight = DirectLight::bsdf;
    spec.settings.microfacets = Microfacets::phong;
    spec.settings.fresnel = Fresnel::schlick;
    spec.settings.energyCompensation = false;
    spec.environment.kind = EnvironmentKind::sky;
    spec.environment.intensity = 0.1;
    spec.environment.rotation = -30;
    spec.environment.visible = false;
    spec.environment.sky = {5, -90, 0, 2, 3.5, 0.1, 4000};
    spec.fog = {{0.1f, 0, 1e6f}, {1, 0.25f, 0}, -0.9999, {{-1, -2, -3}}, {{1e-3, 2, 3}}};
    LightSettings& spot = spec.lights.emplace_back();
    spot.name = "key", spot.kind = LightKind::spot;
    spot.position = {1e-3, -2, 3}, spot.direction = {0, 0, 1}, spot.color = {0.1f, 0, 1};
    spot.intensity = 1e6, spot.innerCone = 10, spot.outerCone = 20;
    LightSettings& quad = spec.lights.emplace_back();
    quad.kind = LightKind::quad, quad.width = 0.3, quad.height = 7, quad.roll = 45, quad.twoSided = true;
    MaterialOverride& gold = spec.materials.emplace_back();
    gold.material = "Gold*", gold.conductor = "gold", gold.baseColor = Color{0.3f, 0, 1}, gold.roughness = 0;
    gold.disneyDiffuse = false, gold.microfacets = Microfacets::beckmann, gold.fresnel = Fresnel::exact;
    spec.materials.emplace_back().material = "*";
    spec.variant = "dusk";
    spec.strict = true;
    spec.stop.samples = 1 << 24;
    spec.priority = 100;
    const json written = toJson(spec);
    EXPECT_EQ(jobFromJson(written), spec);
    EXPECT_EQ(toJson(jobFromJson(parseJson(written.dump()))).dump(), written.dump());
}

TEST(JobFromJson, ReadsRecordsOfVersionsThatKnewLess) {
    const JobSpec old = jobFromJson(json::parse(R"({"camera":"auto","frames":{"count":1,"first":0},
        "image":{"height":360,"tileSize":128,"width":640},"name":"demo","priority":50,
        "scene":{"entry":"a.glb","environment":"","files":{"a.glb":")" +
                                                kDigest + R"("}},
        "settings":{"maxBounces":8,"rouletteStart":4,"seed":0},"stop":{"samples":64}})"));
    JobSpec expected;
    expected.name = "demo";
    expected.scene = {"a.glb", {{"a.glb", kDigest}}, ""};
    expected.image = {.width = 640, .height = 360};
    expected.stop.samples = 64;
    EXPECT_EQ(old, expected);
}

TEST(JobFromJson, NamesThePlaceOfEachFault) {
    const std::vector<std::pair<const char*, std::string>> faults{
        {R"({"image": {"width": 0}})", "/image/width"},
        {R"({"image": {"width": 32769}})", "/image/width"},
        {R"({"image": {"height": "360"}})", "/image/height"},
        {R"({"image": {"height": 1.5}})", "/image/height"},
        {R"({"image": {"tileSize": 12}})", "/image/tileSize"},
        {R"({"image": {"tileSize": 1032}})", "/image/tileSize"},
        {R"({"image": {"width": 32768, "height": 32768, "tileSize": 8}})", "/image/tileSize"},
        {R"({"image": []})", "/image"},
        {R"({"stop": {"samples": 0}})", "/stop/samples"},
        {R"({"stop": {"samples": 16777217}})", "/stop/samples"},
        {R"({"stop": {"samples": -1}})", "/stop/samples"},
        {R"({"frames": {"count": 0}})", "/frames/count"},
        {R"({"frames": {"count": 100001}})", "/frames/count"},
        {R"({"frames": {"first": 2147483647, "count": 2}})", "/frames/count"},
        {R"({"frames": {"step": 0}})", "/frames/step"},
        {R"({"frames": {"first": 2147483000, "count": 10, "step": 1000}})", "/frames/count"},
        {R"({"frames": {"list": "1,x"}})", "/frames/list"},
        {R"({"frames": {"list": "1,5,9", "count": 4}})", "/frames/count"},
        {R"({"frames": {"list": "1,5,9", "first": 2}})", "/frames/first"},
        {R"({"settings": {"culling": "back"}})", "/settings/culling"},
        {R"({"settings": {"cameraFit": "crop"}})", "/settings/cameraFit"},
        {R"({"settings": {"lightUnits": "lumen"}})", "/settings/lightUnits"},
        {R"({"priority": 101})", "/priority"},
        {R"({"priority": true})", "/priority"},
        {R"({"settings": {"seed": -1}})", "/settings/seed"},
        {R"({"settings": {"maxBounces": 1025}})", "/settings/maxBounces"},
        {R"({"settings": {"bounces": 3}})", "/settings/bounces"},
        {R"({"settings": {"lightSelection": "best"}})", "/settings/lightSelection"},
        {R"({"settings": {"energyCompensation": 1}})", "/settings/energyCompensation"},
        {R"({"environment": {"kind": "moon"}})", "/environment/kind"},
        {R"({"environment": {"kind": "file"}})", "/environment/kind"},
        {R"({"environment": {"intensity": -1}})", "/environment/intensity"},
        {R"({"environment": {"kind": "constant", "color": [1, -1, 1]}})", "/environment/color/1"},
        {R"({"environment": {"color": [2, 2, 2]}})", "/environment/color"},
        {R"({"environment": {"sky": {"turbidity": 3}}})", "/environment/sky"},
        {R"({"environment": {"kind": "sky", "sky": {"turbidity": 0}}})", "/environment/sky/turbidity"},
        {R"({"environment": {"kind": "sky", "sky": {"sun": 0}}})", "/environment/sky/sun"},
        {R"({"fog": {"extinction": [1, -1, 1]}})", "/fog/extinction/1"},
        {R"({"fog": {"extinction": 1}})", "/fog/extinction"},
        {R"({"fog": {"albedo": [1, 1, 1.5]}})", "/fog/albedo/2"},
        {R"({"fog": {"anisotropy": 1}})", "/fog/anisotropy"},
        {R"({"fog": {"density": 1}})", "/fog/density"},
        {R"({"fog": {"min": [0, 0, 0]}})", "/fog/max"},
        {R"({"fog": {"max": [0, 0, 0]}})", "/fog/min"},
        {R"({"fog": {"min": [0, 0, 0], "max": [1, 0, 1]}})", "/fog/max/1"},
        {R"({"lights": {}})", "/lights"},
        {R"({"lights": [{}]})", "/lights/0/kind"},
        {R"({"lights": [{"kind": "point"}, {"kind": "lamp"}]})", "/lights/1/kind"},
        {R"({"lights": [{"kind": "point", "radius": 1}]})", "/lights/0/radius"},
        {R"({"lights": [{"kind": "sphere", "radius": 0}]})", "/lights/0/radius"},
        {R"({"lights": [{"kind": "spot", "direction": [0, 0, 0]}]})", "/lights/0/direction"},
        {R"({"lights": [{"kind": "spot", "innerCone": 50}]})", "/lights/0/innerCone"},
        {R"({"lights": [{"kind": "sphere", "position": [0, 1e10, 0]}]})", "/lights/0/position/1"},
        {R"({"lights": [{"kind": "directional", "position": [0, 1, 0]}]})", "/lights/0/position"},
        {R"({"materials": [{"roughness": 1}]})", "/materials/0/material"},
        {R"({"materials": [{"material": ""}]})", "/materials/0/material"},
        {R"({"materials": [{"material": "*", "roughness": 2}]})", "/materials/0/roughness"},
        {R"({"materials": [{"material": "*", "conductor": "wood"}]})", "/materials/0/conductor"},
        {R"({"materials": [{"material": "*", "ior": 0.5}]})", "/materials/0/ior"},
        {R"({"materials": [{"material": "*", "baseColor": [1, 1]}]})", "/materials/0/baseColor"},
        {R"({"materials": [{"material": "*", "baseColor": "#fff"}]})", "/materials/0/baseColor"},
        {R"({"materials": [{"material": "*", "colour": [1, 1, 1]}]})", "/materials/0/colour"},
        {R"({"materials": [{"material": "*", "clearcoatGloss": 1, "clearcoatRoughness": 0}]})",
         "/materials/0/clearcoatGloss"},
        {R"({"variant": 1})", "/variant"},
        {R"({"strict": "yes"})", "/strict"},
        {R"({"sampels": 3})", "/sampels"},
        {R"({"name": 7})", "/name"},
        {R"({"name": "a\u0000b"})", "/name"},
        {R"({"camera": ""})", "/camera"},
        {R"({"scene": null})", "/scene"},
        {R"({"scene": {"entry": null}})", "/scene/entry"},
        {R"({"scene": {"files": null}})", "/scene/files"},
        {R"({"scene": {"entry": "b.glb"}})", "/scene/entry"},
        {R"({"scene": {"entry": "sky.hdr"}})", "/scene/entry"},
        {R"({"scene": {"environment": "a.glb"}})", "/scene/environment"},
        {R"({"scene": {"environment": "dusk.hdr"}})", "/scene/environment"},
        {R"({"scene": {"files": {"c.bin": "abc"}}})", "/scene/files/c.bin"},
        {R"({"scene": {"files": {"c.bin": 7}}})", "/scene/files/c.bin"},
    };
    for (const auto& [patch, pointer] : faults)
        EXPECT_THAT(faultsOfPatch(patch), ElementsAre(pointer)) << patch;
}

TEST(JobFromJson, RefusesPathsThatLeaveTheirFolder) {
    for (const char* path : {"", "/etc/passwd", "../a.bin", "a/../b", "a/..", "./a", "a//b", "a/", "a\\b",
                             "C:/a", "c:a", "a:b", "a\nb", "\x7f", "..", "."}) {
        json job = goodJob();
        job["scene"]["files"][path] = kDigest;
        EXPECT_THAT(faultsOf(job), ElementsAre("/scene/files/" + pointerToken(path))) << path;
    }
    json job = goodJob();
    job["scene"]["files"][std::string("a\0b", 3)] = kDigest;
    job["scene"]["files"][std::string(256, 'x')] = kDigest;
    EXPECT_EQ(faultsOf(job).size(), 2u);
}

TEST(JobFromJson, TakesUnusualButSafePaths) {
    json job = goodJob();
    for (const char* path : {"..a", "a..b/c", "...", "ü/ö.bin", "a b", "%2e%2e", "~", "ab:c", "-rf", "C"})
        job["scene"]["files"][path] = kDigest;
    EXPECT_NO_THROW(jobFromJson(job));
}

TEST(JobFromJson, RefusesAFileThatIsAlsoAFolder) {
    json job = goodJob();
    job["scene"]["files"]["tex"] = kDigest;
    job["scene"]["files"]["tex/wood.png"] = kDigest;
    EXPECT_THAT(faultsOf(job), ElementsAre("/scene/files/tex~1wood.png"));
}

TEST(JobFromJson, ReportsAllFaultsAtOnce) {
    const json job = json::parse(R"({"name": 1, "image": {"width": 0, "height": 0, "depth": 1},
        "scene": {"entry": "a.obj", "files": {"../a": "x", "b.bin": "y"}}, "stop": {"samples": 1.5}, "extra": {}})");
    EXPECT_THAT(faultsOf(job),
                UnorderedElementsAre("/name", "/image/width", "/image/height", "/image/depth", "/scene/entry",
                                     "/scene/entry", "/scene/files/..~1a", "/scene/files/..~1a",
                                     "/scene/files/b.bin", "/stop/samples", "/extra"));
}

TEST(JobFromJson, RefusesWhatIsNoObject) {
    for (const char* text : {"null", "[]", "7", "\"job\"", "true"})
        EXPECT_THAT(faultsOf(json::parse(text)), ElementsAre("")) << text;
    EXPECT_THAT(faultsOf(json::object()), ElementsAre("/scene"));
}

TEST(JobFromJson, SaysOneSentenceForPeople) {
    EXPECT_STREQ(errorOf([] {
                     json job = goodJob();
                     job["image"]["width"] = 0;
                     jobFromJson(job);
                 }).what(),
                 "the job: /image/width must be a whole number from 1 to 32768, not 0");
}

TEST(JobSchema, StatesTheSameRangesAsTheReader) {
    const json schema = jobSchema();
    EXPECT_EQ(schema["required"], json::parse(R"(["scene"])"));
    const json& width = schema["properties"]["image"]["properties"]["width"];
    EXPECT_EQ(width["maximum"], 32768);
    for (const int value : {width["minimum"].get<int>(), width["maximum"].get<int>()}) {
        json job = goodJob();
        job["image"]["width"] = value;
        EXPECT_NO_THROW(jobFromJson(job));
        job["image"]["width"] = value == 1 ? 0 : value + 1;
        EXPECT_THAT(faultsOf(job), ElementsAre("/image/width"));
    }
}

Lease goodLease() {
    Lease lease;
    lease.id = "l1";
    lease.epoch = 1ull << 60;
    lease.jobId = "j1";
    lease.spec = jobFromJson(goodJob());
    lease.spec.image = {.width = 640, .height = 360};
    lease.frame = -3;
    lease.passes = {{0, {0, 1}}, {14, {64, 64}}};
    return lease;
}

TEST(Lease, SurvivesTheWire) {
    const Lease lease = goodLease();
    EXPECT_EQ(leaseFromJson(parseJson(toJson(lease).dump())), lease);
}

TEST(Lease, ObeysTheRulesOfItsJobAndImage) {
    json outside = toJson(goodLease());
    outside["passes"][0]["tile"] = 15;  // 640x360 in tiles of 128: 5 x 3
    EXPECT_THAT(errorOf([&] { leaseFromJson(outside); }).what(),
                HasSubstr("tile 15 of an image of 15 tiles"));

    json sizeless = toJson(goodLease());
    sizeless["spec"]["image"].erase("width");
    EXPECT_THAT(errorOf([&] { leaseFromJson(sizeless); }).what(), HasSubstr("no size"));

    json escaping = toJson(goodLease());
    escaping["spec"]["scene"]["files"]["../../home/a"] = kDigest;
    EXPECT_EQ(codeOf([&] { leaseFromJson(escaping); }), ErrorCode::invalidArgument);

    json bare = toJson(goodLease());
    bare.erase("epoch");
    bare["passes"][1].erase("count");
    const Error error = errorOf([&] { leaseFromJson(bare); });
    EXPECT_THAT(error.faults,
                ElementsAre(Fault{"/epoch", "is missing"}, Fault{"/passes/1/count", "is missing"}));
}

TEST(JobOverTime, EveryMemberSurvivesTheWire) {
    JobSpec job = jobFromJson(goodJob());
    job.view = {ViewKind::perspective, {1, 2, 3}, {4, 5, 6}, {0, 0, 1}, 12, 3, 0, 2.8, 0.02, 7, 5, 15};
    job.motion = {30, "Walk", true, 7.5, 0.5, 16};
    job.output = {true, true, true, MatteManifest::sidecar, true};
    job.settings.filter = PixelFilter::blackmanHarris;
    job.settings.filterRadius = 2;
    job.settings.jitter = false;
    job.settings.sampler = Sampler::sobol;
    job.settings.strata = 4;
    EXPECT_EQ(jobFromJson(toJson(job)), job);
}

TEST(JobOverTime, MembersThatContradictEachOtherAreFaults) {
    const auto faultsOf = [](const char* member, const char* text) {
        json job = goodJob();
        job[member] = json::parse(text);
        std::vector<std::string> places;
        for (const Fault& fault : errorOf([&] { jobFromJson(job); }).faults) places.push_back(fault.pointer);
        return places;
    };
    EXPECT_THAT(faultsOf("view", R"({"kind": "perspective", "eye": [1, 1, 1], "target": [1, 1, 1]})"),
                ElementsAre("/view/target"));
    EXPECT_THAT(faultsOf("view", R"({"eye": [1, 1, 1]})"), ElementsAre("/view/kind"));
    EXPECT_THAT(faultsOf("view", R"({"up": [0, 0, 0]})"), ElementsAre("/view/up"));
    EXPECT_THAT(faultsOf("view", R"({"apertureRadius": 0.1, "fNumber": 2})"), ElementsAre("/view/fNumber"));
    EXPECT_THAT(faultsOf("view", R"({"kind": "panorama", "apertureRadius": 0.1})"),
                ElementsAre("/view/apertureRadius"));
    EXPECT_THAT(faultsOf("view", R"({"blades": 2})"), ElementsAre("/view/blades"));
    EXPECT_THAT(faultsOf("motion", R"({"shutterSteps": 6})"), ElementsAre("/motion/shutterSteps"));
    EXPECT_THAT(faultsOf("motion", R"({"fps": 0})"), ElementsAre("/motion/fps"));
    EXPECT_THAT(faultsOf("output", R"({"lightPaths": 1})"), ElementsAre("/output/lightPaths"));
    json whitted = goodJob();
    whitted["settings"]["integrator"] = "whitted";
    whitted["output"] = {{"lightPaths", true}};
    EXPECT_THAT(errorOf([&] { jobFromJson(whitted); }).faults,
                ElementsAre(Fault{"/output/lightPaths", "applies to settings.integrator path only"}));
    whitted["output"] = {{"uv", true}, {"cryptomatte", true}};
    EXPECT_NO_THROW(jobFromJson(whitted));
}

TEST(WorkerHello, SurvivesTheWireAndIgnoresNews) {
    const WorkerHello hello{"w-1", "render3", "llvmpipe", "Mesa 25.0", "0.1.0", "s2", {"s0", "s1"}};
    json written = toJson(hello);
    written["ended"][1] = 7;
    EXPECT_THAT(errorOf([&] { helloFromJson(written); }).faults,
                ElementsAre(Fault{"/ended/1", "must be a string, not 7"}));
    written["ended"][1] = "s1";
    written["wantSeconds"] = 5;
    EXPECT_EQ(helloFromJson(written), hello);
    written.erase("worker");
    EXPECT_EQ(codeOf([&] { helloFromJson(written); }), ErrorCode::invalidArgument);
}

TEST(ResultReceipt, SurvivesTheWire) {
    const ResultReceipt receipt{3, 4};
    EXPECT_EQ(receiptFromJson(toJson(receipt)), receipt);
}

}  // namespace
}  // namespace tilefarm
