// A query as bytes.
#include <string>
#include <utility>

#include <grapeshot/adb/detail/query_state.hpp>
#include <grapeshot/core/bytes.hpp>

namespace grapeshot {

using detail::Side;
using detail::SidePair;

namespace {

enum class SavedTask : std::uint8_t { none, contacts, leafPairs };

bool isSideOf(const Tree& tree, Side side) {
    if (!isLeaf(side)) {
        return side < tree.nodes.size();
    }
    const std::size_t node = indexOf(side) >> 2U;
    if (node >= tree.nodes.size()) {
        return false;
    }
    const ChildRef child = tree.nodes[node].child[side & 3U];
    return child != noChild && isLeaf(child);
}

SidePair readPair(const Tree& a, const Tree& b, ByteReader& in) {
    const auto pair = in.get<std::uint64_t>();
    in.require(isSideOf(a, detail::sideA(pair)) && isSideOf(b, detail::sideB(pair)), "a pair of no nodes");
    return pair;
}

}  // namespace

void Query::save(ByteWriter& out) const {
    const State& s = *m_state;
    const SavedTask task = s.task == State::Task::contacts    ? SavedTask::contacts
                           : s.task == State::Task::leafPairs ? SavedTask::leafPairs
                                                              : SavedTask::none;
    out.put(task);
    if (task == SavedTask::none) {
        return;
    }
    out.put(static_cast<std::uint8_t>(s.order));
    out.put(s.maxDistance);
    out.put(s.descent.pose.rotation);
    out.put(s.descent.pose.translation);
    out.put(static_cast<std::uint8_t>(s.finished));
    out.put(static_cast<std::uint8_t>(s.leafPending));
    out.put(s.leafPending ? s.descent.found : SidePair{0});
    out.put(s.descent.work);
    out.put(static_cast<std::uint64_t>(s.descent.depth));
    for (std::size_t i = 0; i < s.descent.depth; ++i) {
        out.put(detail::sidePair(s.descent.stackA[i], s.descent.stackB[i]));
    }
    out.put(s.queue.pushed());
    out.put(static_cast<std::uint64_t>(s.queue.entries().size()));
    for (const detail::PairQueue::Entry& entry : s.queue.entries()) {
        out.put(entry.margin);
        out.put(entry.number);
        out.put(entry.pair);
    }
}

Query Query::load(const Tree& a, const Tree& b, ByteReader& in) {
    Query query(a, b);
    State& s = *query.m_state;
    const auto task = in.get<std::uint8_t>();
    in.require(task <= static_cast<std::uint8_t>(SavedTask::leafPairs), "task " + std::to_string(task));
    if (SavedTask{task} == SavedTask::none) {
        return query;
    }
    const auto order = in.get<std::uint8_t>();
    in.require(order <= static_cast<std::uint8_t>(Order::bestFirst), "order " + std::to_string(order));
    const auto distance = in.get<float>();
    Pose pose;
    pose.rotation = in.matrix();
    pose.translation = in.vector();
    const bool usable = s.start(SavedTask{task} == SavedTask::contacts ? State::Task::contacts : State::Task::leafPairs,
                                pose, Order{order}, distance);
    in.require(usable, "a pose that is not rigid");
    s.finished = in.flag();
    s.leafPending = in.flag();
    const auto found = in.get<std::uint64_t>();
    if (s.leafPending) {
        in.require(isSideOf(a, detail::sideA(found)) && isSideOf(b, detail::sideB(found)) && detail::bothLeaves(found),
                   "a pair of no leaves");
        s.descent.found = found;
    }
    s.descent.work = in.get<std::uint64_t>();
    for (std::size_t left = in.count(sizeof(SidePair)); left > 0; --left) {
        detail::push(s.descent, readPair(a, b, in));
    }
    const auto pushed = in.get<std::uint64_t>();
    std::vector<detail::PairQueue::Entry> entries(in.count(sizeof(float) + sizeof(std::uint64_t) + sizeof(SidePair)));
    for (detail::PairQueue::Entry& entry : entries) {
        entry.margin = in.get<float>();
        entry.number = in.get<std::uint64_t>();
        in.require(entry.margin == entry.margin && entry.number < pushed, "an entry out of order");
        entry.pair = readPair(a, b, in);
    }
    s.queue.restore(std::move(entries), pushed);
    return query;
}

}  // namespace grapeshot
