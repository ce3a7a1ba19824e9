#include <grapeshot/plugin/registration.hpp>

#include <new>

#include <grapeshot/plugin/detail/context.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

using detail::Context;
using detail::Contexts;

Status registerAlgorithms(btCollisionDispatcher* dispatcher, const Settings& settings) noexcept {
    if (dispatcher == nullptr) {
        return Status::nullPointer;
    }
    if (!isValid(settings)) {
        return Status::badSettings;
    }
    try {
        std::shared_ptr<Context> context = Contexts::instance().find(dispatcher);
        // If none of its places are ours, another dispatcher lives at this address now.
        if (!context || !context->isIn(*dispatcher)) {
            context = std::make_shared<Context>(settings);
            Contexts::instance().insert(dispatcher, context);
        }
        context->settings = settings;
        ++context->settingsVersion;
        context->install(*dispatcher);
        return Status::ok;
    } catch (...) {
        return Status::outOfMemory;
    }
}

Status unregisterAlgorithms(btCollisionDispatcher* dispatcher) noexcept {
    if (dispatcher == nullptr) {
        return Status::nullPointer;
    }
    try {
        const std::shared_ptr<Context> context = Contexts::instance().find(dispatcher);
        if (!context || !context->isIn(*dispatcher)) {
            Contexts::instance().remove(dispatcher, false);  // another dispatcher lived at this address
            return Status::notRegistered;
        }
        context->framed = false;  // pairs that exist go on as with any dispatcher
        const bool allHeld = context->uninstall(*dispatcher);
        Contexts::instance().remove(dispatcher, !allHeld);
        return Status::ok;
    } catch (...) {
        return Status::outOfMemory;
    }
}

bool isRegistered(const btCollisionDispatcher* dispatcher) noexcept {
    const std::shared_ptr<Context> context = Contexts::instance().find(dispatcher);
    return context && !context->cells.empty() && context->heldCells(*dispatcher) == context->cells.size();
}

const StepStatistics& statistics(const btCollisionDispatcher* dispatcher) noexcept {
    static const StepStatistics none;
    const std::shared_ptr<Context> context = Contexts::instance().find(dispatcher);
    return context && context->isIn(*dispatcher) ? context->statistics : none;
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
