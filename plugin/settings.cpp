#include <grapeshot/plugin/settings.hpp>

#include <cmath>

#include <grapeshot/plugin/status.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

Settings Settings::exact() noexcept {
    Settings settings;
    settings.maxManifolds = 16;
    settings.reuse = 0;
    settings.searchWork = unlimited;
    return settings;
}

bool isValid(const Settings& settings) noexcept {
    // Written so that a NaN is out of range.
    const auto share = [](float value, float most) { return value > 0 && value <= most; };
    const bool knownMethod = settings.method >= Method::automatic && settings.method <= Method::scf;
    const bool knownInterior = settings.interior == Interior::surface || settings.interior == Interior::solid;
    return knownMethod && knownInterior && settings.maxManifolds >= 1 && settings.maxManifolds <= 16 &&
           share(settings.contactSpacing, 10) && share(settings.mergeDistance, 1) && settings.slack >= 0 &&
           settings.slack <= 1 && settings.reuse >= 0 && settings.reuse <= 0.9F && settings.lean >= 0 &&
           settings.lean <= 0.5F && settings.speculativeLimit >= 0 && settings.threads >= 1 && settings.threads <= 256;
}

std::string_view name(Status status) noexcept {
    switch (status) {
        case Status::ok:
            return "ok";
        case Status::nullPointer:
            return "null pointer";
        case Status::badSettings:
            return "a setting is out of range";
        case Status::notRegistered:
            return "not registered with this dispatcher";
        case Status::unsupportedShape:
            return "the shape is no triangle mesh";
        case Status::unusableMesh:
            return "the mesh cannot be used";
        case Status::badArgument:
            return "an argument is out of range";
        case Status::outOfMemory:
            return "out of memory";
        case Status::badState:
            return "the bytes are no saved state";
        case Status::otherWorld:
            return "the state is of another world";
        case Status::stillBuilding:
            return "the tree of a mesh is still being built";
    }
    return "unknown";
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
