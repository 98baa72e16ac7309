#include "server/study/page.h"

#include <nlohmann/json.hpp>

#include "server/web/study_template.h"
#include "shared/error/error.h"

namespace tilefarm {
namespace {

// No text of a study can end the script that it stands in.
std::string scriptOf(const nlohmann::json& data) {
    std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    for (size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 6)
        text.replace(at, 1, "\\u003c");
    return text;
}

std::string filled(std::string page, std::string_view place, std::string_view with) {
    const size_t at = page.find(place);
    if (at == std::string::npos)
        throw Error(ErrorCode::internal, "the study's page has no " + std::string(place));
    return page.replace(at, place.size(), with);
}

}  // namespace

std::string studyPage(const nlohmann::json& view, const nlohmann::json& pictures) {
    nlohmann::json shown = view;
    shown["request"]["job"].erase("scene");  // up to megabytes of names of files
    std::string page = filled(std::string(studyTemplate()), "/*study*/", scriptOf(shown));
    page = filled(std::move(page), "/*pictures*/", scriptOf(pictures));
    return filled(std::move(page), "/*chart.js*/", chartScript());
}

}  // namespace tilefarm
