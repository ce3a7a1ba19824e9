// What answers whether two meshes intersect, seen alike by all suites; and the rivals and peers there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <grapeshot/adb/query.hpp>

namespace grapeshot::bench {

class FclModel;

struct Answer {
    bool collides = false;
    bool certain = true;
    std::uint64_t work = 0;  ///< our units; 0: the peer does not count them
};
[[nodiscard]] inline Answer answerOf(bool collides) {
    return {collides};
}
[[nodiscard]] inline Answer answerOf(const Answer& answer) {
    return answer;
}
[[nodiscard]] inline Answer answerOf(const Decision& decision) {
    return {decision.collides, decision.certain, decision.work};
}

/// For one pair of meshes. Copies share what they stand on.
struct Peer {
    std::string name;
    std::function<Answer(const Pose& bInA)> decide;
    /// How many of the poses collide: the loop that is timed, without an indirect call for each.
    std::function<std::size_t(std::span<const Pose>)> count;
};

/// @param decide from a pose to bool, Answer or Decision; need not be copyable
template <class Decide>
[[nodiscard]] Peer makePeer(std::string name, Decide decide) {
    const auto shared = std::make_shared<Decide>(std::move(decide));
    return {std::move(name), [shared](const Pose& pose) { return answerOf((*shared)(pose)); },
            [shared](std::span<const Pose> poses) {
                std::size_t colliding = 0;
                for (const Pose& pose : poses) {
                    colliding += answerOf((*shared)(pose)).collides ? 1U : 0U;
                }
                return colliding;
            }};
}

/// Our own query. Trees must outlive every peer that is made of them.
[[nodiscard]] inline Peer queryPeer(std::string name, const Tree& a, const Tree& b, const DecideSettings& settings) {
    return makePeer(std::move(name),
                    [query = Query(a, b), settings](const Pose& pose) mutable { return query.decide(pose, settings); });
}

/// FCL as Debian ships it: double precision, oriented boxes with rectangle swept spheres, first contact only.
[[nodiscard]] Peer fclPeer(MeshView a, MeshView b);
/// The same with models that are there already; a later refit of them counts here too.
[[nodiscard]] Peer fclPeer(const FclModel& a, const FclModel& b);
/// Bullet's GImpact as Debian ships it, margin 0. It has no way to stop at the first contact. Meshes must outlive it.
[[nodiscard]] Peer gimpactPeer(MeshView a, MeshView b);
/// ODE's meshes (OPCODE) as Debian ships them, double precision, one contact. Meshes must outlive it.
[[nodiscard]] Peer odePeer(MeshView a, MeshView b);
/// What game teams do: edge collapse to about so many triangles, then the exact test. Nothing if the mesh has no more
/// than that.
[[nodiscard]] std::optional<Peer> decimatedPeer(MeshView mesh, std::size_t triangles);

}  // namespace grapeshot::bench
