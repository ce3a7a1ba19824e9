#include <grapeshot/plugin/detail/saved_pair.hpp>

#include <string>

#include <grapeshot/adb/tree_file.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

void put(ByteWriter& out, const ContentKey& key) {
    out.put(key.low);
    out.put(key.high);
}

ContentKey getKey(ByteReader& in) {
    ContentKey key;
    key.low = in.get<std::uint64_t>();
    key.high = in.get<std::uint64_t>();
    return key;
}

}  // namespace

ModelKeys keysOf(const MeshModel& model) {
    return {contentKey(model.tree.mesh()), contentKey(model.tree)};
}

void save(const SavedPair& pair, ByteWriter& out) {
    out.put(static_cast<std::uint8_t>(pair.kind));
    for (std::size_t i = 0; i < 2; ++i) {
        if (isMeshOf(pair.kind, i)) {
            put(out, pair.keys[i].mesh);
            put(out, pair.keys[i].tree);
        }
    }
    save(pair.state, out);
    save(pair.ahead, out);
    out.put(pair.lastNeed);
    out.put(pair.age);
    out.put(pair.staleness);
    out.put(static_cast<std::uint8_t>(pair.cutShort));
    out.put(static_cast<std::uint8_t>(pair.unwanted));
    out.put(static_cast<std::uint64_t>(pair.manifolds.size()));
    for (const ManifoldState& manifold : pair.manifolds) {
        save(manifold, out);
    }
}

SavedPair loadPair(ByteReader& in, const PresentPair& present, bool& otherWorld) {
    SavedPair pair;
    const auto kind = in.get<std::uint8_t>();
    in.require(
        kind > static_cast<std::uint8_t>(PairKind::foreign) && kind <= static_cast<std::uint8_t>(PairKind::solidMesh),
        "pair of kind " + std::to_string(kind));
    pair.kind = PairKind{kind};
    otherWorld = pair.kind != present.kind;
    bool sameTrees = true;
    for (std::size_t i = 0; i < 2; ++i) {
        if (isMeshOf(pair.kind, i)) {
            pair.keys[i].mesh = getKey(in);
            pair.keys[i].tree = getKey(in);
            otherWorld = otherWorld || present.models[i] == nullptr || pair.keys[i].mesh != present.keys[i].mesh;
            sameTrees = sameTrees && pair.keys[i].tree == present.keys[i].tree;
        }
    }
    if (otherWorld) {
        return pair;
    }
    const std::size_t a = pair.kind == PairKind::solidMesh ? 1 : 0;
    const LoadedModels models{present.models[a], present.models[1 - a], sameTrees};
    pair.state = loadPairState(in, models);
    pair.ahead = loadContactSet(in, models);
    pair.lastNeed = in.get<std::uint64_t>();
    pair.age = in.get<std::uint32_t>();
    pair.staleness = in.get<std::uint32_t>();
    pair.cutShort = in.flag();
    pair.unwanted = in.flag();
    for (std::size_t left = in.count(sizeof(int)); left > 0; --left) {
        pair.manifolds.push_back(loadManifoldState(in));
    }
    return pair;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
