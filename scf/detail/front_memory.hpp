// What a tracker remembers of its last traversal: the pairs of pieces it opened, how far those were apart that it did
// not, and which pairs at the end of it were found to be clear.
//
// This work is based on:
// Stephen Ehmann, Ming Lin. Accurate and Fast Proximity Queries Between Polyhedra Using Convex Surface Decomposition.
// Eurographics 2001 (the front of the tree of node pairs, kept from step to step)
// Rene Weller, Gabriel Zachmann. Kinetic Separation Lists for Continuous Collision Detection of Deformable Objects.
// VRIPHYS 2006 (a pair is looked at again when it may have changed)
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <grapeshot/scf/detail/moved_since.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot::detail {

/// A pair of pieces that the traversal came to. Records stand in its order: below a pair, what was opened of it.
struct FrontRecord {
    BallPair pair;
    std::uint32_t size = 1;  ///< records of it and below it
    /// m: so much nearer may the surfaces have come before it must be looked at again. Of an opened pair: so much are
    /// all children apart, beyond the reach, that have no record; of one at the end: all triangles. Infinite: nothing
    /// is left to look at. Not above 0: not known.
    float slack = 0;
    float weight = 0;  ///< of one at the end, as `overlappingBalls` has it, when its parent was looked at
    bool isEnd = false;
};

/// What the records hold for, beside the surfaces: with anything else they are worthless.
struct FrontKey {
    TrackMode mode = TrackMode::exact;
    float exclusion = 0;
    /// What the traversal ends at: 0 leaves, else cells of this size (spacing) or number (front), by the mode.
    float cells = 0;
    friend bool operator==(const FrontKey&, const FrontKey&) = default;
};

struct FrontMemory {
    std::vector<FrontRecord> records;
    FrontKey key;
    float reach = 0;  ///< m, that slacks count from
    SurfaceBefore a, b;
};

/// A traversal that goes where it must, by what it knows of the one before.

}  // namespace grapeshot::detail
