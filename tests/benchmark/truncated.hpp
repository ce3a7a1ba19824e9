// The plainest rival of an estimate: a hierarchy that ends early. Where only a few triangles are left below, touching
// boxes count as touching triangles.
#pragma once

#include <cstddef>
#include <vector>

#include <grapeshot/adb/detail/descent.hpp>
#include <grapeshot/adb/detail/stack_storage.hpp>
#include <grapeshot/adb/tree.hpp>

#include "peer.hpp"

namespace grapeshot::bench {

inline constexpr int truncations[] = {16, 64, 256};  ///< triangles below the last box

/// The tree with everything below nodes of at most so many triangles cut off; only for TruncatedQuery.
[[nodiscard]] Tree truncated(const Tree& tree, int triangles);

/// The library's own descent, with its kernels and its order, to the first pair of last boxes that touch.
class TruncatedQuery {
  public:
    enum class Outcome { no, yes, undecided };

    /// Truncated trees, which must outlive it.
    TruncatedQuery(const Tree& a, const Tree& b);
    TruncatedQuery(const TruncatedQuery&) = delete;
    TruncatedQuery& operator=(const TruncatedQuery&) = delete;

    void start(const Pose& bInA);
    /// Goes on for so many units at most.
    Outcome goOn(std::uint64_t units);
    [[nodiscard]] std::uint64_t work() const { return m_descent.work; }

  private:
    const Tree* m_a;
    const Tree* m_b;
    detail::Descent m_descent;
    detail::StackStorage m_stack;
    bool m_found = false;
};

/// Two copies of a mesh.
[[nodiscard]] Peer truncatedPeer(const Tree& tree, int triangles);

}  // namespace grapeshot::bench
