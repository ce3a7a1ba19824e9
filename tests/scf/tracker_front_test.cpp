// The front that is kept from step to step: nothing is lost by it, and less is looked at.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <set>

#include <grapeshot/scf/detail/cells.hpp>
#include <grapeshot/scf/detail/front_file.hpp>
#include <grapeshot/scf/detail/moved_since.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <scf/tracked_scenes.hpp>
#include <support/fault_of.hpp>
#include <support/poses.hpp>

namespace grapeshot::test {
namespace {

/// Two bodies, or a roll, that drift about at a speed that changes, and stand still now and then.
class FrontWalk {
  public:
    FrontWalk(std::uint64_t seed, float speed) : m_random(seed), m_speed(speed) {}

    /// The next moment, as frames of the scenes count, and how fast.
    float next() {
        const double pace = m_random.uniform(0, 1);
        m_time += pace < 0.2 ? 0 : m_speed * static_cast<float>(pace);
        return m_time;
    }

  private:
    Random m_random;
    float m_speed;
    float m_time = 14;
};

float frontMost(const std::vector<Eigen::Vector3f>& from, const std::vector<Eigen::Vector3f>& to) {
    float most = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        most = std::max(most, (to[i] - from[i]).norm());
    }
    return most;
}

struct FrontCounts {
    std::uint64_t kept = 0, opened = 0, work = 0, workWithout = 0;
    std::size_t contacts = 0;

    void add(const TrackResult& with, const TrackResult& without) {
        kept += with.frontKept;
        opened += with.frontOpened;
        work += with.work;
        workWithout += without.work;
        contacts += with.contacts.size();
    }
    void expectUse() const {
        EXPECT_GT(kept, 1000U);
        EXPECT_GT(opened, 100U);
        EXPECT_GT(contacts, 500U);
        EXPECT_LT(work, workWithout);
    }
};

/// All that is told of the contacts, in their order.
std::vector<std::byte> frontContacts(const TrackResult& result) {
    TrackResult contacts;
    contacts.contacts = result.contacts;
    return bytesOf(contacts);
}

TEST(KeptFront, ExactModeFindsTheSameOfDeformingBodies) {
    const TwoBumpy scene(14);
    TrackSettings with = TwoBumpy::settings(TrackMode::exact);
    TrackSettings without = with;
    without.keepFront = false;
    for (const Displacement::Source source : {Displacement::Source::given, Displacement::Source::measured}) {
        FrontCounts counts;
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            FrontWalk walk(seed, 0.1F);
            Tracker kept(scene.a, scene.b);
            Tracker plain(scene.a, scene.b);
            TwoBumpy::Frame before = scene.at(walk.next());
            for (int step = 0; step < 25; ++step) {
                const TwoBumpy::Frame where = scene.at(walk.next());
                SurfaceState a = where.stateA();
                SurfaceState b = where.stateB();
                a.displacement = {source, frontMost(before.a, where.a)};
                b.displacement = {source, frontMost(before.b, where.b)};
                const TrackResult one = kept.step(a, b, with);
                const TrackResult other = plain.step(a, b, without);
                EXPECT_TRUE(one.certain);
                EXPECT_EQ(frontContacts(one), frontContacts(other)) << seed << ", " << step;
                EXPECT_EQ(std::isfinite(one.nearer), step > 0);
                counts.add(one, other);
                before = where;
            }
        }
        counts.expectUse();
    }
}

TEST(KeptFront, ExactModeFindsTheSameOfABodyWithItself) {
    const Roll roll;
    TrackSettings with = Roll::settings(TrackMode::exact);
    with.maxDistance = 0.1F;
    TrackSettings without = with;
    without.keepFront = false;
    FrontCounts counts;
    FrontWalk walk(7, 0.2F);
    Tracker kept(roll.tree);
    Tracker plain(roll.tree);
    for (int step = 0; step < 12; ++step) {
        const std::vector<Eigen::Vector3f> positions = roll.at(walk.next());
        SurfaceState state{positions, {}, Stretch::measured(), {}};
        state.displacement = Displacement::measured();
        const TrackResult one = kept.step(state, with);
        const TrackResult other = plain.step(state, without);
        EXPECT_TRUE(one.certain);
        EXPECT_EQ(frontContacts(one), frontContacts(other)) << step;
        counts.add(one, other);
    }
    counts.expectUse();
}

TEST(KeptFront, OfRigidBodiesThePosesAreEnough) {
    const TwoBumpy scene(14);
    TrackSettings with = TwoBumpy::settings(TrackMode::exact);
    TrackSettings without = with;
    without.keepFront = false;
    Random random(5);
    FrontCounts counts;
    Tracker kept(scene.a, scene.b);
    Tracker plain(scene.a, scene.b);
    Pose inA{Eigen::Matrix3f::Identity(), {1.7F, 0.1F, -0.2F}};
    Pose whole;
    for (int step = 0; step < 40; ++step) {
        if (step % 5 != 0) {
            inA = compose(
                {Eigen::AngleAxisf(0.002F, random.direction()).toRotationMatrix(), 0.002F * random.direction()}, inA);
        }
        // Both on a platform that goes where it will.
        whole = step % 4 == 0 ? Pose{random.rotation(), 5 * random.direction()} : whole;
        const TrackResult one = kept.step(rigidState(whole), rigidState(compose(whole, inA)), with);
        const TrackResult other = plain.step(rigidState(whole), rigidState(compose(whole, inA)), without);
        EXPECT_EQ(frontContacts(one), frontContacts(other)) << step;
        EXPECT_LE(one.nearer, step == 0 ? std::numeric_limits<float>::infinity() : 0.02F);
        counts.add(one, other);
    }
    counts.expectUse();
}

TEST(KeptFront, EveryPairOfCellsIsStillRepresented) {
    const TwoBumpy scene(20);
    for (const TrackMode mode : {TrackMode::resolution, TrackMode::budget}) {
        TrackSettings settings = TwoBumpy::settings(mode);
        settings.maxDives = 0;  // whose number would not depend on what is known
        const bool isSampled = mode == TrackMode::budget;
        const detail::Cells cellsA = isSampled ? detail::cellsOfCount(scene.a, settings.frontCells)
                                               : detail::cellsOfRadius(scene.a, settings.spacing);
        const detail::Cells cellsB = isSampled ? detail::cellsOfCount(scene.b, settings.frontCells)
                                               : detail::cellsOfRadius(scene.b, settings.spacing);
        const auto cellsOf = [&](const TrackResult& result) {
            std::set<std::pair<std::uint32_t, std::uint32_t>> cells;
            for (const TrackedContact& contact : result.contacts) {
                cells.emplace(cellsA.cellOf(scene.a, contact.pair.triangleA),
                              cellsB.cellOf(scene.b, contact.pair.triangleB));
            }
            return cells;
        };
        TrackSettings without = settings;
        without.keepFront = false;
        TrackSettings exactly = without;
        exactly.mode = TrackMode::exact;
        FrontCounts counts;
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            FrontWalk walk(seed, 0.03F);
            Tracker kept(scene.a, scene.b);
            Tracker plain(scene.a, scene.b);
            Tracker exact(scene.a, scene.b);
            for (int step = 0; step < 20; ++step) {
                const TwoBumpy::Frame where = scene.at(walk.next());
                SurfaceState a = where.stateA();
                SurfaceState b = where.stateB();
                a.displacement = b.displacement = Displacement::measured();
                const TrackResult one = kept.step(a, b, settings);
                EXPECT_TRUE(one.certain);
                EXPECT_EQ(cellsOf(one), cellsOf(exact.step(a, b, exactly))) << seed << ", " << step;
                counts.add(one, plain.step(a, b, without));
            }
        }
        EXPECT_GT(counts.kept, 500U);
        EXPECT_GT(counts.opened, 50U);
        EXPECT_LT(counts.work, counts.workWithout);
    }
}

TEST(KeptFront, AtRestAShortBudgetEndsInACertificate) {
    const TwoBumpy scene(24);
    TrackSettings settings = TwoBumpy::settings(TrackMode::budget);
    settings.auditShare = 0.5F;
    const TwoBumpy::Frame where = scene.at(16);
    SurfaceState a = where.stateA();
    SurfaceState b = where.stateB();
    a.displacement = b.displacement = Displacement::given(0);
    int certainWith = 0;
    int certainWithout = 0;
    for (const bool keepFront : {true, false}) {
        settings.keepFront = keepFront;
        Tracker tracker(scene.a, scene.b);
        for (int step = 0; step < 40; ++step) {
            const TrackResult result = tracker.step(a, b, settings, {.work = 800});
            (keepFront ? certainWith : certainWithout) += result.certain ? 1 : 0;
        }
    }
    EXPECT_GT(certainWith, 10);
    EXPECT_EQ(certainWithout, 0);
}

TEST(KeptFront, IsSavedAndLoadedAndNotBelievedBlindly) {
    const TwoBumpy scene(12);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::exact);
    FrontWalk walk(3, 0.1F);
    Tracker through(scene.a, scene.b);
    Tracker saved(scene.a, scene.b);
    std::uint64_t kept = 0;
    for (int step = 0; step < 12; ++step) {
        const TwoBumpy::Frame where = scene.at(walk.next());
        SurfaceState a = where.stateA();
        SurfaceState b = where.stateB();
        a.displacement = b.displacement = Displacement::measured();
        const std::uint64_t work = step % 3 == 0 ? unlimited : 150;
        const TrackResult one = through.step(a, b, settings, {.work = work});
        EXPECT_EQ(bytesOf(saved.step(a, b, settings, {.work = work})), bytesOf(one));
        kept += one.frontKept;
        Tracker other(scene.a, scene.b);
        other.load(saved.save());
        EXPECT_EQ(other.save(), saved.save());
        saved = other;
    }
    EXPECT_GT(kept, 500U);
    // Of another pair of meshes, or a number that cannot be: the hash is not the only guard.
    const std::vector<std::byte> bytes = through.save();
    detail::FrontMemory front;
    front.records = {{{0, 0}, 1, 0.1F, 0, false}};
    const detail::TrackedTrees trees{scene.a, scene.b, false};
    const auto load = [&](const detail::FrontMemory& memory) {
        std::vector<std::byte> written;
        ByteWriter writer(written);
        detail::putFront(memory, writer);
        ByteReader reader(written);
        return detail::frontFrom(reader, trees);
    };
    EXPECT_EQ(load(front).records.size(), 1U);
    const BallRef child = scene.a.nodes[0].child[0];
    const BallRef childB = scene.b.nodes[0].child[0];
    front.records = {{{0, 0}, 2, 0.1F, 0, false}, {{child, childB}, 1, 0.1F, 0, false}};
    EXPECT_EQ(load(front).records.size(), 2U);
    for (const auto& spoil : std::vector<void (*)(detail::FrontMemory&)>{
             [](detail::FrontMemory& m) { m.records[0].size = 1; },
             [](detail::FrontMemory& m) { m.records[0].size = 3; },
             [](detail::FrontMemory& m) { m.records[1].size = 0; },
             [](detail::FrontMemory& m) { m.records[1].pair.a = 1'000'000; },
             [](detail::FrontMemory& m) {
                 m.records[1].pair = {0, 0};
             },
             [](detail::FrontMemory& m) { m.records[1].pair.b = ballLeafBit | 1'000'000U; },
             [](detail::FrontMemory& m) { m.records[1].slack = std::numeric_limits<float>::quiet_NaN(); },
             [](detail::FrontMemory& m) { m.records[1].weight = 2; }, [](detail::FrontMemory& m) { m.reach = -1; },
             [](detail::FrontMemory& m) { m.a.positions.resize(3); },
             [](detail::FrontMemory& m) { m.b.extent = std::numeric_limits<float>::infinity(); },
             [](detail::FrontMemory& m) {
                 m.a.pose = Pose{2 * Eigen::Matrix3f::Identity(), {0, 0, 0}};
             }}) {
        detail::FrontMemory bad = front;
        spoil(bad);
        EXPECT_EQ(faultOf([&] { static_cast<void>(load(bad)); }), Fault::badFile);
    }
}

TEST(KeptFront, AGivenBoundIsBelieved) {
    const TwoBumpy scene(12);
    const TrackSettings settings = TwoBumpy::settings(TrackMode::exact);
    Tracker believes(scene.a, scene.b);
    Tracker measures(scene.a, scene.b);
    TrackResult believed;
    TrackResult measured;
    for (const int frame : {2, 16}) {  // from far apart to deep in each other
        const TwoBumpy::Frame where = scene.at(frame);
        SurfaceState a = where.stateA();
        SurfaceState b = where.stateB();
        a.displacement = b.displacement = Displacement::given(0);
        believed = believes.step(a, b, settings);
        a.displacement = b.displacement = Displacement::measured();
        measured = measures.step(a, b, settings);
    }
    EXPECT_GT(measured.contacts.size(), 50U);
    EXPECT_LT(believed.contacts.size(), measured.contacts.size());
    EXPECT_EQ(believed.nearer, 0);
    EXPECT_GT(measured.nearer, 0.1F);
    SurfaceState bad = rigidState();
    bad.displacement = Displacement::given(-1);
    EXPECT_EQ(believes.step(bad, rigidState(), settings).fault, Fault::badSetting);
}

TEST(MovedSince, IsAtLeastWhatAnyPointComesNearer) {
    Random random(11);
    const TwoBumpy scene(5);
    double tightest = 0;
    for (int round = 0; round < 200; ++round) {
        std::vector<Eigen::Vector3f> before = scene.meshA.vertices;
        std::vector<Eigen::Vector3f> now = before;
        const auto size = static_cast<float>(random.uniform(0, 0.02));
        for (Eigen::Vector3f& vertex : now) {
            vertex += size * static_cast<float>(random.uniform(0, 1)) * random.direction();
        }
        const auto nudge = [&](const Pose& pose) {
            return compose({Eigen::AngleAxisf(size, random.direction()).toRotationMatrix(), size * random.direction()},
                           pose);
        };
        const Pose poseA{random.rotation(), random.direction()};
        const Pose poseB{random.rotation(), 3 * random.direction()};
        SurfaceState a{before, poseA, Stretch::measured(), {}};
        a.displacement = Displacement::measured();
        SurfaceState b = rigidState(poseB);
        detail::SurfaceBefore beforeA;
        detail::SurfaceBefore beforeB;
        const auto deformation = [&](const SurfaceState& state, const detail::SurfaceBefore& last,
                                     const BallTree& tree) {
            return detail::deformationSince(last, state, tree.surface, tree.extent);
        };
        EXPECT_FALSE(std::isfinite(detail::nearerThanBefore(beforeA, a, deformation(a, beforeA, scene.a), beforeB, b,
                                                            deformation(b, beforeB, scene.b))));
        detail::remember(a, deformation(a, beforeA, scene.a), beforeA);
        detail::remember(b, deformation(b, beforeB, scene.b), beforeB);
        EXPECT_EQ(detail::nearerThanBefore(beforeA, a, deformation(a, beforeA, scene.a), beforeB, b,
                                           deformation(b, beforeB, scene.b)),
                  0);
        a.positions = now;
        a.pose = nudge(poseA);
        b.pose = nudge(poseB);
        const float bound = detail::nearerThanBefore(beforeA, a, deformation(a, beforeA, scene.a), beforeB, b,
                                                     deformation(b, beforeB, scene.b));
        ASSERT_TRUE(std::isfinite(bound));
        for (int i = 0; i < 400; ++i) {
            const std::size_t v = random.bits() % before.size();
            const std::size_t w = random.bits() % scene.meshB.vertices.size();
            const float from = (apply(poseA, before[v]) - apply(poseB, scene.meshB.vertices[w])).norm();
            const float to = (apply(*a.pose, now[v]) - apply(*b.pose, scene.meshB.vertices[w])).norm();
            EXPECT_LE(from - to, bound);
            tightest = std::max(tightest, static_cast<double>((from - to) / bound));
        }
    }
    EXPECT_GT(tightest, 0.3);
}

}  // namespace
}  // namespace grapeshot::test
