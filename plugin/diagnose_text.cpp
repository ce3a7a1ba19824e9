#include <ostream>

#include <grapeshot/plugin/diagnose.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

std::string_view name(FindingCode code) noexcept {
    switch (code) {
        case FindingCode::noAlgorithm:
            return "noAlgorithm";
        case FindingCode::overtaken:
            return "overtaken";
        case FindingCode::oldAlgorithm:
            return "oldAlgorithm";
        case FindingCode::zeroMassPair:
            return "zeroMassPair";
        case FindingCode::notFinite:
            return "notFinite";
        case FindingCode::notRigid:
            return "notRigid";
        case FindingCode::farFromOrigin:
            return "farFromOrigin";
        case FindingCode::noInertia:
            return "noInertia";
        case FindingCode::unusableMesh:
            return "unusableMesh";
        case FindingCode::openMesh:
            return "openMesh";
        case FindingCode::insideOut:
            return "insideOut";
        case FindingCode::degenerateTriangles:
            return "degenerateTriangles";
        case FindingCode::imprecise:
            return "imprecise";
        case FindingCode::badScale:
            return "badScale";
        case FindingCode::nonUniformScale:
            return "nonUniformScale";
        case FindingCode::tiny:
            return "tiny";
        case FindingCode::huge:
            return "huge";
        case FindingCode::badMargin:
            return "badMargin";
        case FindingCode::largeMargin:
            return "largeMargin";
        case FindingCode::refused:
            return "refused";
        case FindingCode::degraded:
            return "degraded";
        case FindingCode::mandatoryOverBudget:
            return "mandatoryOverBudget";
        case FindingCode::droppedRegions:
            return "droppedRegions";
        case FindingCode::fallbacks:
            return "fallbacks";
    }
    return "unknown";
}

std::string_view name(Severity severity) noexcept {
    switch (severity) {
        case Severity::note:
            return "note";
        case Severity::warning:
            return "warning";
        case Severity::error:
            return "error";
    }
    return "unknown";
}

std::string toText(const Finding& finding) {
    std::string text(name(finding.severity));
    text += ": ";
    text += name(finding.code);
    if (finding.first >= 0 && finding.second >= 0) {
        text += " (bodies " + std::to_string(finding.first) + " and " + std::to_string(finding.second) + ")";
    } else if (finding.first >= 0) {
        text += " (body " + std::to_string(finding.first) + ")";
    }
    return text + ": " + finding.message;
}

std::string toText(const Diagnosis& diagnosis) {
    if (diagnosis.status != Status::ok) {
        return "no diagnosis: " + std::string(name(diagnosis.status)) + "\n";
    }
    std::string text;
    for (const Finding& finding : diagnosis.findings) {
        text += toText(finding) + "\n";
    }
    return text.empty() ? "nothing to report\n" : text;
}

std::ostream& operator<<(std::ostream& out, const Finding& finding) {
    return out << toText(finding);
}

std::ostream& operator<<(std::ostream& out, const Diagnosis& diagnosis) {
    return out << toText(diagnosis);
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
