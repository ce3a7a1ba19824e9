#include <grapeshot/scf/depth.hpp>
#include <grapeshot/scf/detail/state_bytes.hpp>

namespace grapeshot {
namespace {

constexpr std::uint64_t depthMagic = 0x0131'4850'4544'5347U;  // "GSDEPH1", then the version
constexpr std::size_t bytesPerSummit = 30;

}  // namespace

std::vector<std::byte> saveDepths(const DepthMemory& memory, const BallTree& a, const BallTree& b) {
    return detail::sealedState(depthMagic, a, b, [&](ByteWriter& writer) {
        writer.put(std::uint64_t{memory.summits.size()});
        for (const DepthMemory::Summit& summit : memory.summits) {
            writer.put(summit.vertex);
            writer.put(summit.triangle);
            for (const std::uint32_t anchor : summit.anchors) {
                writer.put(anchor);
            }
            writer.put(summit.age);
            writer.put(summit.side);
            writer.put(static_cast<std::uint8_t>(summit.isOfA ? 1 : 0));
        }
    });
}

DepthMemory loadDepths(std::span<const std::byte> bytes, const BallTree& a, const BallTree& b) {
    DepthMemory memory;
    detail::openState(depthMagic, bytes, a, b, "loadDepths", [&](ByteReader& reader) {
        const std::size_t count = reader.count(bytesPerSummit);
        for (std::size_t i = 0; i < count; ++i) {
            DepthMemory::Summit summit;
            summit.vertex = reader.get<std::uint32_t>();
            summit.triangle = reader.get<std::uint32_t>();
            for (std::uint32_t& anchor : summit.anchors) {
                anchor = reader.get<std::uint32_t>();
                reader.require(anchor < a.surface.triangles.size(), "an anchor out of range");
            }
            summit.age = reader.get<std::uint32_t>();
            summit.side = reader.get<std::int8_t>();
            summit.isOfA = reader.flag();
            const Surface& own = summit.isOfA ? a.surface : b.surface;
            const Surface& other = summit.isOfA ? b.surface : a.surface;
            reader.require(summit.vertex < own.rest.size() && summit.triangle < other.triangles.size() &&
                               (summit.side == 1 || summit.side == -1),
                           "a summit out of range");
            memory.summits.push_back(summit);
        }
    });
    return memory;
}

}  // namespace grapeshot
