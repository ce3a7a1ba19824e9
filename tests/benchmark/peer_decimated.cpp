#include "decimation.hpp"
#include "peer.hpp"

namespace grapeshot::bench {

std::optional<Peer> decimatedPeer(MeshView mesh, std::size_t triangles) {
    if (mesh.triangles.size() <= triangles) {
        return {};
    }
    const auto tree = std::make_shared<const Tree>(build(decimated(mesh, triangles).view()));
    DecideSettings exact = DecideSettings::exact();
    exact.tryWitness = false;
    return makePeer(
        "decimated " + std::to_string(triangles),
        [tree, query = Query(*tree, *tree), exact](const Pose& pose) mutable { return query.decide(pose, exact); });
}

}  // namespace grapeshot::bench
