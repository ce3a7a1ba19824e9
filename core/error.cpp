#include <grapeshot/core/error.hpp>

namespace grapeshot {

std::string_view name(Fault fault) noexcept {
    switch (fault) {
        case Fault::emptyMesh:
            return "emptyMesh";
        case Fault::noSurface:
            return "noSurface";
        case Fault::indexOutOfRange:
            return "indexOutOfRange";
        case Fault::notFinite:
            return "notFinite";
        case Fault::tooLarge:
            return "tooLarge";
        case Fault::topologyChanged:
            return "topologyChanged";
        case Fault::notRigid:
            return "notRigid";
        case Fault::badSetting:
            return "badSetting";
        case Fault::badHierarchy:
            return "badHierarchy";
        case Fault::badFile:
            return "badFile";
        case Fault::limitExceeded:
            return "limitExceeded";
    }
    return "unknownFault";
}

Error::Error(Fault fault, const std::string& detail, const std::string& place)
    : std::runtime_error(std::string(name(fault)) + ": " + detail + " (" + place + ")"),
      m_fault(fault),
      m_place(place) {}

}  // namespace grapeshot
