#include <grapeshot/adb/reference/settings.hpp>

#include <string>

#include <grapeshot/core/error.hpp>

namespace grapeshot::reference {

namespace {

/// Written so that a NaN fails.
void require(bool holds, const std::string& field, const std::string& value, const std::string& range) {
    if (!holds) {
        throw Error(Fault::badSetting, field + " is " + value + ", not " + range, "settings");
    }
}

}  // namespace

Settings slide() {
    Settings settings;
    settings.kMin = 1;
    settings.insert = Insert::overlapping;
    return settings;
}

Settings chapter2007() {
    return {};
}

Settings star() {
    Settings settings;
    settings.kMin = 1;
    return settings;
}

void requireUsable(const FillSettings& settings) {
    require(settings.grid >= 1 && settings.grid <= 16, "grid", std::to_string(settings.grid), "1 to 16");
    require(settings.tau > 0 && settings.tau < 1e6, "tau", std::to_string(settings.tau), "above 0 and finite");
}

void requireUsable(const Settings& settings) {
    require(settings.pMin >= 0 && settings.pMin <= 1, "pMin", std::to_string(settings.pMin), "0 to 1");
    require(settings.kMin >= 1, "kMin", std::to_string(settings.kMin), "1 or more");
    require(settings.mostCells >= 1 && settings.mostCells <= 10, "mostCells", std::to_string(settings.mostCells),
            "1 to 10");
}

}  // namespace grapeshot::reference
