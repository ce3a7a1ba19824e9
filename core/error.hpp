// Faults in input data, named.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace grapeshot {

/// What is wrong with the input.
enum class Fault {
    emptyMesh,        ///< no vertices or no triangles
    noSurface,        ///< every triangle is degenerate
    indexOutOfRange,  ///< a triangle names a vertex that does not exist
    notFinite,        ///< NaN or infinity
    tooLarge,         ///< a coordinate or a count beyond what the data structures hold
    topologyChanged,  ///< a refit with another number of vertices
    notRigid,         ///< a pose whose rotation is no rotation
    badSetting,       ///< a setting outside its documented range
    badHierarchy,     ///< nodes that form no tree, or triangles that are missing or in two leaves
    badFile,          ///< a file that cannot be read as what it claims to be
    limitExceeded,    ///< a limit on memory, time or size was hit
};

std::string_view name(Fault fault) noexcept;

/// Thrown by building and loading, never by queries and never through Bullet. `what()` reads "<fault>: <detail>
/// (<place>)".
class Error : public std::runtime_error {
  public:
    /// @param detail names the offending value, `place` where it stands ("vertex 17", "mesh.obj:12").
    Error(Fault fault, const std::string& detail, const std::string& place);
    [[nodiscard]] Fault fault() const noexcept { return m_fault; }
    [[nodiscard]] const std::string& place() const noexcept { return m_place; }

  private:
    Fault m_fault;
    std::string m_place;
};

}  // namespace grapeshot
