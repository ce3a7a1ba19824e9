#include "fcl_model.hpp"
#include "peer.hpp"

namespace grapeshot::bench {

Peer fclPeer(MeshView a, MeshView b) {
    const FclModel modelA(a);
    return fclPeer(modelA, a.triangles.data() == b.triangles.data() ? modelA : FclModel(b));
}

Peer fclPeer(const FclModel& a, const FclModel& b) {
    return makePeer("FCL OBBRSS", [a, b](const Pose& bInA) { return a.collides(b, bInA); });
}

}  // namespace grapeshot::bench
