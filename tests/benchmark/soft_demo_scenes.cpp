#include "soft_demo_scenes.hpp"

#include "soft_demo_parts.hpp"

namespace grapeshot::bench {

std::vector<SoftDemo> softDemos() {
    std::vector<SoftDemo> all;
    for (const auto scenes : {demo::nodeScenes(), demo::clusterScenes(), demo::deformableScenes()}) {
        all.insert(all.end(), scenes.begin(), scenes.end());
    }
    return all;
}

}  // namespace grapeshot::bench
