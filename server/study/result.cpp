#include "server/study/result.h"

#include <fmt/format.h>

#include <algorithm>

#include "server/study/measure.h"
#include "server/study/verdict.h"

namespace tilefarm {
namespace {

using nlohmann::json;

// How often that the mean differs by chance: |z| above 4 once in 16,000. A bias without a mean, as of a blur,
// shows in the squared one.
constexpr double kBiasedZ = 4, kBiasedShare = 0.5;

double valueOf(const json& cell, const char* member) {
    return cell.at(member).at("value").get<double>();
}

// An mse at or below 0 is all the reference's own noise, and a share of it says nothing.
bool isBiased(const json& cell) {
    const double mse = valueOf(cell, "mse");
    return std::abs(cell.at("bias").at("z").get<double>()) > kBiasedZ ||
           (mse > 0 && cell.at("squaredBias").get<double>() > kBiasedShare * mse);
}

// By seed, as the same seed's noise is in both.
json ratioToBase(const json& base, const json& cell, bool timesSeconds) {
    const auto values = [](const json& of, const char* member) {
        return of.at("perSeed").at(member).get<std::vector<double>>();
    };
    const auto baseErrors = values(base, "mse"), errors = values(cell, "mse");
    const auto baseSeconds = values(base, "deviceSeconds"), seconds = values(cell, "deviceSeconds");
    std::vector<double> ratios;
    for (size_t i = 0; i < errors.size(); ++i)
        ratios.push_back(baseErrors[i] / errors[i] * (timesSeconds ? baseSeconds[i] / seconds[i] : 1));
    return toJson(geometricEstimate(ratios));
}

// What remains of the variance in the time that the base took; the bias stays.
json atBaseSeconds(const json& base, const json& cell) {
    const double share = valueOf(base, "deviceSeconds") / valueOf(cell, "deviceSeconds");
    if (!(share > 0)) return {};
    const double error =
        std::max(0.0, cell.at("squaredBias").get<double>()) + cell.at("variance").get<double>() / share;
    return {{"mse", error}, {"samplesFactor", share}};
}

struct Point {
    uint32_t cell;
    CostPoint cost;
};

std::vector<Point> pointsOf(const std::map<uint32_t, json>& measured) {
    std::vector<Point> points;
    for (const auto& [cell, result] : measured)
        points.push_back({cell, {valueOf(result, "deviceSeconds"), valueOf(result, "mse")}});
    return points;
}

std::map<uint32_t, bool> frontOf(const std::map<uint32_t, json>& measured) {
    const auto points = pointsOf(measured);
    std::vector<CostPoint> costs;
    for (const Point& point : points) costs.push_back(point.cost);
    const auto front = paretoFront(costs);
    std::map<uint32_t, bool> of;
    for (size_t i = 0; i < points.size(); ++i) of[points[i].cell] = front[i];
    return of;
}

json cellView(const json& result, const json* base, uint32_t samples, bool onFront) {
    json view = result;
    view["samples"] = samples;
    view["pareto"] = onFront;
    view["biased"] = isBiased(result);
    view["errorRatio"] = base ? ratioToBase(*base, result, false) : json();
    view["efficiencyRatio"] = base ? ratioToBase(*base, result, true) : json();
    view["atBaseSeconds"] = base ? atBaseSeconds(*base, result) : json();
    return view;
}

}  // namespace

json studyResult(const StudyPlan& plan, const std::map<uint32_t, json>& measured) {
    const auto front = frontOf(measured);
    const auto variantCount = static_cast<uint32_t>(plan.variants().size());
    json variants = json::array();
    for (const StudyVariant& variant : plan.variants())
        variants.push_back(
            {{"label", variant.label}, {"settings", variant.settings}, {"cells", json::array()}});
    for (const auto& [index, result] : measured) {
        const StudyCell& cell = plan.cells().at(index);
        const auto base = measured.find(index - cell.variant);  // the first of the same samples
        const json* ofBase = base == measured.end() ? nullptr : &base->second;
        variants[cell.variant]["cells"].push_back(cellView(result, ofBase, cell.samples, front.at(index)));
    }
    json result{{"variants", variants}};
    const bool whole = measured.size() == plan.cells().size() && variantCount > 0;
    result["verdict"] = whole ? json(studyVerdict(result)) : json();
    return result;
}

std::string studyCsv(const json& result) {
    std::string text =
        "variant,samples,device_seconds,mse,mse_low,mse_high,variance,squared_bias,bias,bias_low,bias_high,"
        "bias_percent,bias_z,efficiency,efficiency_ratio,efficiency_ratio_low,efficiency_ratio_high,"
        "mse_at_base_seconds,pareto\r\n";
    const auto number = [](const json& value) { return value.is_number() ? value.dump() : std::string(); };
    for (const json& variant : result.at("variants")) {
        std::string label = variant.at("label");
        for (size_t at = 0; (at = label.find('"', at)) != std::string::npos; at += 2)
            label.insert(at, 1, '"');
        for (const json& cell : variant.at("cells")) {
            text += "\"" + label + "\"," + cell.at("samples").dump();
            for (const char* member :
                 {"/deviceSeconds/value", "/mse/value", "/mse/low", "/mse/high", "/variance", "/squaredBias",
                  "/bias/value", "/bias/low", "/bias/high", "/bias/percent", "/bias/z", "/efficiency/value",
                  "/efficiencyRatio/value", "/efficiencyRatio/low", "/efficiencyRatio/high",
                  "/atBaseSeconds/mse"})
                text += "," + number(cell.value(json::json_pointer(member), json()));
            text += cell.at("pareto") == true ? ",1\r\n" : ",0\r\n";
        }
    }
    return text;
}

}  // namespace tilefarm
