#include "truncated.hpp"

#include <algorithm>

namespace grapeshot::bench {

Tree truncated(const Tree& tree, int triangles) {
    std::vector<int> below(tree.nodes.size(), 0);
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {  // children stand after their parents
        for (const ChildRef child : tree.nodes[i].child) {
            if (child == noChild) {
                continue;
            }
            below[i] += isLeaf(child) ? static_cast<int>(std::ranges::count_if(tree.leaves[indexOf(child)].triangle,
                                                                               [](auto t) { return t != noTriangle; }))
                                      : below[child];
        }
    }
    Tree result;
    result.lower = tree.lower;
    result.upper = tree.upper;
    result.radius = tree.radius;
    result.leaves.resize(1);  // never looked at
    struct Task {
        std::uint32_t from, to;
    };
    std::vector<Task> tasks{{0, 0}};
    const auto copy = [&](std::uint32_t from) {
        result.nodes.push_back(tree.nodes[from]);
        result.distributions.push_back(tree.distributions[from]);
        return static_cast<std::uint32_t>(result.nodes.size() - 1);
    };
    copy(0);
    while (!tasks.empty()) {
        const Task task = tasks.back();
        tasks.pop_back();
        for (int slot = 0; slot < 4; ++slot) {
            const ChildRef child = tree.nodes[task.from].child[slot];
            if (child == noChild) {
                continue;
            }
            if (isLeaf(child) || below[child] <= triangles) {
                result.nodes[task.to].child[slot] = leafBit;
            } else {
                const std::uint32_t place = copy(child);
                result.nodes[task.to].child[slot] = place;
                tasks.push_back({child, place});
            }
        }
    }
    return result;
}

TruncatedQuery::TruncatedQuery(const Tree& a, const Tree& b) : m_a(&a), m_b(&b) {
    detail::setTrees(m_descent, a, b);
    m_stack.lendTo(m_descent);
}

void TruncatedQuery::start(const Pose& bInA) {
    m_found = false;
    m_descent.depth = 0;
    m_descent.work = 0;
    m_descent.pose = bInA;
    if (detail::prepare(bInA, m_a->radius, m_b->radius, 0, m_descent.prepared) == detail::PoseVerdict::usable) {
        detail::push(m_descent, detail::sidePair(0, 0));
    }
}

TruncatedQuery::Outcome TruncatedQuery::goOn(std::uint64_t units) {
    if (m_found) {
        return Outcome::yes;
    }
    switch (detail::toLeafPair(m_descent, units)) {
        case detail::DescentEnd::exhausted:
            return Outcome::no;
        case detail::DescentEnd::found:
            m_found = true;
            return Outcome::yes;
        case detail::DescentEnd::budget:
            break;
    }
    return Outcome::undecided;
}

Peer truncatedPeer(const Tree& tree, int triangles) {
    struct Truncated {
        explicit Truncated(Tree t) : tree(std::move(t)), query(tree, tree) {}
        Tree tree;
        TruncatedQuery query;
    };
    return makePeer("truncated " + std::to_string(triangles),
                    [truncated = std::make_unique<Truncated>(truncated(tree, triangles))](const Pose& pose) {
                        TruncatedQuery& query = truncated->query;
                        query.start(pose);
                        const bool yes = query.goOn(unlimited) == TruncatedQuery::Outcome::yes;
                        return Answer{yes, !yes, query.work()};
                    });
}

}  // namespace grapeshot::bench
