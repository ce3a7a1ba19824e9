#include <grapeshot/plugin/diagnose.hpp>

#include <algorithm>
#include <cstdio>

#include <grapeshot/plugin/detail/diagnosis_parts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace detail {

std::string shortNumber(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

void diagnoseBudget(const Patient& patient, std::vector<Finding>& findings) {
    if (patient.context == nullptr) {
        return;
    }
    const StepStatistics& s = patient.context->statistics;
    const auto add = [&](FindingCode code, Severity severity, double value, std::string message) {
        findings.push_back({code, severity, -1, -1, nullptr, value, std::move(message)});
    };
    const auto pairs = std::to_string(s.pairs.size());
    if (s.refused > 0) {
        add(FindingCode::refused, Severity::error, s.refused,
            std::to_string(s.refused) + " of " + pairs + " pairs got no contacts in the last step: " + s.lastRefusal +
                ".");
    }
    if (s.degraded > 0) {
        std::string message = std::to_string(s.degraded) + " of " + pairs +
                              " pairs were cut short in the last step, after " + std::to_string(s.work) +
                              " work units in all";
        message += s.longestWait > 0 ? ", and one has had no more than its mandatory slice for " +
                                           std::to_string(s.longestWait) + " steps"
                                     : std::string();
        message += s.budget != unlimited ? ": raise Settings::frameBudget, now " + std::to_string(s.budget) + "."
                                         : std::string(": raise Settings::pairBudget.");
        add(FindingCode::degraded, Severity::warning, s.degraded, std::move(message));
    }
    if (s.budget != unlimited && s.mandatory > s.budget) {
        const double ratio =
            static_cast<double>(s.mandatory) / static_cast<double>(std::max<std::uint64_t>(1, s.budget));
        add(FindingCode::mandatoryOverBudget, Severity::warning, ratio,
            "The mandatory slices of the last step came to " + std::to_string(s.mandatory) +
                " work units, the budget is " + std::to_string(s.budget) +
                ": nothing was left to split by importance. Raise Settings::frameBudget, or let fewer pairs meet.");
    }
    if (s.droppedRegions > 0) {
        add(FindingCode::droppedRegions, Severity::note, static_cast<double>(s.droppedRegions),
            std::to_string(s.droppedRegions) +
                " contact regions of the last step were left out: raise Settings::maxManifolds, now " +
                std::to_string(patient.context->settings.maxManifolds) + ", if bodies rock.");
    }
    if (s.fallbacks > 0) {
        add(FindingCode::fallbacks, Severity::note, static_cast<double>(s.fallbacks),
            std::to_string(s.fallbacks) +
                " pairs since registration were handed to Bullet's GImpact algorithm: GImpact compounds, heightfields "
                "and other concave shapes that are no triangle mesh.");
    }
}

}  // namespace detail

Diagnosis diagnose(const btCollisionWorld* world) noexcept {
    Diagnosis result;
    const auto failed = [](Status status) {
        Diagnosis none;
        none.status = status;
        return none;
    };
    if (world == nullptr) {
        return failed(Status::nullPointer);
    }
    try {
        detail::Patient patient;
        patient.world = world;
        patient.dispatcher = dynamic_cast<const btCollisionDispatcher*>(world->getDispatcher());
        if (patient.dispatcher == nullptr) {
            return failed(Status::badArgument);
        }
        const std::shared_ptr<detail::Context> context = detail::Contexts::instance().find(patient.dispatcher);
        if (context && context->isIn(*patient.dispatcher)) {
            patient.context = context.get();
        }
        const btCollisionObjectArray& objects = world->getCollisionObjectArray();
        for (int i = 0; i < objects.size(); ++i) {
            detail::Patient::Body body;
            body.object = objects[i];
            body.moves = !objects[i]->isStaticOrKinematicObject();
            detail::appendLeaves(*objects[i]->getCollisionShape(), btTransform::getIdentity(), body.leaves);
            patient.bodies.push_back(std::move(body));
        }
        detail::diagnosePairs(patient, result.findings);
        detail::diagnoseBodies(patient, result.findings);
        detail::diagnoseMeshes(patient, result.findings);
        detail::diagnoseBudget(patient, result.findings);
        std::stable_sort(result.findings.begin(), result.findings.end(), [](const Finding& x, const Finding& y) {
            return x.severity != y.severity ? x.severity > y.severity : x.code < y.code;
        });
        return result;
    } catch (...) {
        return failed(Status::outOfMemory);
    }
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
