#include <grapeshot/adb/tree_file.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <system_error>
#include <type_traits>

#include <unistd.h>
#include <xxhash.h>

#include <grapeshot/core/content_key.hpp>
#include <grapeshot/core/error.hpp>

namespace grapeshot {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> magic{'G', 'S', 'T', 'R', 'E', 'E', '\r', '\n'};
constexpr std::uint32_t version = 4;

/// Everything before the arrays. No padding, so that its bytes may be hashed.
struct Header {
    std::array<char, 8> title = magic;
    std::uint32_t format = version;
    std::uint32_t coordinateBits = 8 * sizeof(float);
    std::array<std::uint32_t, 4> sizes{sizeof(Node), sizeof(NodeDistribution), sizeof(LeafBlock), sizeof(Triangle)};
    std::uint64_t nodes = 0, leaves = 0, vertices = 0, triangles = 0;
    ContentKey mesh;
    std::int32_t maxLeafTriangles = 0, bins = 0, tuningPoses = 0, nothing = 0;
    std::array<float, 8> bounds{};  ///< lower, upper, radius, nothing
    std::array<float, 24> whole{};  ///< of the surface: mean, covariance, unit, stepRates, nothing
    ContentKey arrays;
    ContentKey own;  ///< of all before it
};
static_assert(sizeof(Header) == 256 && std::is_trivially_copyable_v<Header>);

ContentKey keyOf(XXH128_hash_t hash) {
    return {hash.low64, hash.high64};
}

ContentKey ownHash(const Header& header) {
    return keyOf(XXH3_128bits(&header, offsetof(Header, own)));
}

/// The arrays in the order in which they stand in the file.
template <class TreeType, class Run>
void forEachArray(TreeType& tree, const Run& run) {
    run(tree.nodes);
    run(tree.distributions);
    run(tree.leaves);
    run(tree.vertices);
    run(tree.triangles);
}

ContentKey arraysHash(const Tree& tree) {
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
    if (state == nullptr) {
        throw std::bad_alloc();
    }
    XXH3_128bits_reset(state.get());
    forEachArray(tree, [&](const auto& array) {
        XXH3_128bits_update(state.get(), array.data(), array.size() * sizeof(array[0]));
    });
    return keyOf(XXH3_128bits_digest(state.get()));
}

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& file) {
    throw Error(Fault::badFile, what, file.string());
}

std::string systemReason() {
    return std::generic_category().message(errno);
}

/// Every child stands behind its parent, every node but the root and every leaf is some slot's, once.
void requireSound(const Tree& tree, const std::filesystem::path& file) {
    const auto at = [](const char* what, std::size_t index) { return std::string(what) + " " + std::to_string(index); };
    std::vector<char> nodeReached(tree.nodes.size(), 0);
    std::vector<char> leafReached(tree.leaves.size(), 0);
    for (std::size_t node = 0; node < tree.nodes.size(); ++node) {
        for (const ChildRef child : tree.nodes[node].child) {
            if (child == noChild) {
                continue;
            }
            std::vector<char>& reached = isLeaf(child) ? leafReached : nodeReached;
            const std::size_t index = indexOf(child);
            if (index >= reached.size() || (!isLeaf(child) && index <= node) || reached[index] != 0) {
                fail("child " + std::to_string(index) + " is out of place", file.string() + ": " + at("node", node));
            }
            reached[index] = 1;
        }
    }
    std::vector<char> triangleReached(tree.triangles.size(), 0);
    for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
        if (leafReached[leaf] == 0) {
            fail("belongs to no node", file.string() + ": " + at("leaf", leaf));
        }
        const auto& lanes = tree.leaves[leaf].triangle;
        const auto* const end = std::find(std::begin(lanes), std::end(lanes), noTriangle);
        if (end == std::begin(lanes) || std::any_of(end, std::end(lanes), [](auto t) { return t != noTriangle; })) {
            fail("is empty or has a gap", file.string() + ": " + at("leaf", leaf));
        }
        for (const std::uint32_t triangle : std::span(std::begin(lanes), end)) {
            if (triangle >= triangleReached.size() || triangleReached[triangle] != 0) {
                fail("triangle " + std::to_string(triangle) + " is out of place",
                     file.string() + ": " + at("leaf", leaf));
            }
            triangleReached[triangle] = 1;
        }
    }
    for (std::size_t triangle = 0; triangle < tree.triangles.size(); ++triangle) {
        if (triangleReached[triangle] == 0) {
            fail("belongs to no leaf", file.string() + ": " + at("triangle", triangle));
        }
        for (const std::uint32_t vertex : tree.triangles[triangle]) {
            if (vertex >= tree.vertices.size()) {
                fail("vertex " + std::to_string(vertex) + " does not exist",
                     file.string() + ": " + at("triangle", triangle));
            }
        }
    }
    for (std::size_t node = 1; node < tree.nodes.size(); ++node) {
        if (nodeReached[node] == 0) {
            fail("belongs to no node", file.string() + ": " + at("node", node));
        }
    }
}

/// A file that is removed unless it is published.
class Draft {
  public:
    explicit Draft(const std::filesystem::path& file) : m_file(file), m_draft(file) {
        // Two processes, or two threads of one, must not write the same draft.
        static std::atomic<std::uint64_t> count{0};
        m_draft += "." + std::to_string(::getpid()) + "." + std::to_string(count++) + ".draft";
        m_stream.open(m_draft, std::ios::binary | std::ios::trunc);
    }
    ~Draft() {
        if (!m_published) {
            m_stream.close();
            std::error_code ignored;
            std::filesystem::remove(m_draft, ignored);
        }
    }
    Draft(const Draft&) = delete;
    Draft& operator=(const Draft&) = delete;

    void write(const void* data, std::size_t size) {
        m_stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
    }
    void publish() {
        m_stream.close();
        if (!m_stream) {
            fail("cannot be written: " + systemReason(), m_file);
        }
        std::error_code error;
        std::filesystem::rename(m_draft, m_file, error);
        if (error) {
            fail("cannot be renamed: " + error.message(), m_file);
        }
        m_published = true;
    }

  private:
    std::filesystem::path m_file, m_draft;
    std::ofstream m_stream;
    bool m_published = false;
};

}  // namespace

ContentKey contentKey(const Tree& tree) {
    return arraysHash(tree);
}

void saveTree(const Tree& tree, const BuildSettings& settings, const std::filesystem::path& file) {
    Header header;
    header.nodes = tree.nodes.size();
    header.leaves = tree.leaves.size();
    header.vertices = tree.vertices.size();
    header.triangles = tree.triangles.size();
    header.mesh = contentKey(tree.mesh());
    header.maxLeafTriangles = settings.maxLeafTriangles;
    header.bins = settings.bins;
    header.tuningPoses = settings.tuningPoses;
    for (int axis = 0; axis < 3; ++axis) {
        header.bounds[static_cast<std::size_t>(axis)] = tree.lower[axis];
        header.bounds[static_cast<std::size_t>(axis) + 3] = tree.upper[axis];
    }
    header.bounds[6] = tree.radius;
    std::ranges::copy(tree.whole.mean, header.whole.begin());
    for (std::size_t column = 0; column < 3; ++column) {
        std::ranges::copy(tree.whole.covariance[column],
                          header.whole.begin() + 4 * static_cast<std::ptrdiff_t>(column + 1));
    }
    header.whole[16] = tree.whole.unit;
    std::ranges::copy(tree.stepRates, header.whole.begin() + 17);
    header.arrays = arraysHash(tree);
    header.own = ownHash(header);
    Draft draft(file);
    draft.write(&header, sizeof(header));
    forEachArray(tree, [&](const auto& array) { draft.write(array.data(), array.size() * sizeof(array[0])); });
    draft.publish();
}

Tree loadTree(const std::filesystem::path& file, MeshView mesh, const BuildSettings& settings) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        fail("cannot be opened: " + systemReason(), file);
    }
    Header header;
    if (!stream.read(reinterpret_cast<char*>(&header), sizeof(header))) {
        fail("ends within its header", file);
    }
    const Header expected;
    if (header.title != expected.title) {
        fail("is no tree", file);
    }
    if (header.format != expected.format) {
        fail("version " + std::to_string(header.format) + " where " + std::to_string(version) + " is read", file);
    }
    if (header.coordinateBits != expected.coordinateBits || header.sizes != expected.sizes) {
        fail("was written by another build of the library", file);
    }
    if (header.own != ownHash(header)) {
        fail("its header was changed", file);
    }
    if (header.mesh != contentKey(mesh) || header.maxLeafTriangles != settings.maxLeafTriangles ||
        header.bins != settings.bins || header.tuningPoses != settings.tuningPoses) {
        fail("belongs to another mesh or other settings", file);
    }
    constexpr std::uint64_t most = std::uint64_t{1} << 31U;  // indices have 31 bits
    if (header.nodes == 0 || std::max({header.nodes, header.leaves, header.vertices, header.triangles}) >= most) {
        fail("its counts are wild", file);
    }
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(file, error);
    const std::uint64_t expectedSize = sizeof(Header) + header.nodes * (sizeof(Node) + sizeof(NodeDistribution)) +
                                       header.leaves * sizeof(LeafBlock) + header.vertices * sizeof(Eigen::Vector3f) +
                                       header.triangles * sizeof(Triangle);
    if (error || size != expectedSize) {
        fail(std::to_string(size) + " bytes where " + std::to_string(expectedSize) + " should be", file);
    }
    Tree tree;
    tree.nodes.resize(header.nodes);
    tree.distributions.resize(header.nodes);
    tree.leaves.resize(header.leaves);
    tree.vertices.resize(header.vertices);
    tree.triangles.resize(header.triangles);
    forEachArray(tree, [&](auto& array) {
        stream.read(reinterpret_cast<char*>(array.data()),
                    static_cast<std::streamsize>(array.size() * sizeof(array[0])));
    });
    if (!stream) {
        fail("cannot be read to its end", file);
    }
    if (header.arrays != arraysHash(tree)) {
        fail("was changed since it was written", file);
    }
    for (int axis = 0; axis < 3; ++axis) {
        tree.lower[axis] = header.bounds[static_cast<std::size_t>(axis)];
        tree.upper[axis] = header.bounds[static_cast<std::size_t>(axis) + 3];
    }
    tree.radius = header.bounds[6];
    for (std::size_t i = 0; i < 4; ++i) {
        tree.whole.mean[i] = header.whole[i];
        for (std::size_t column = 0; column < 3; ++column) {
            tree.whole.covariance[column][i] = header.whole[4 * (column + 1) + i];
        }
    }
    tree.whole.unit = header.whole[16];
    std::copy_n(header.whole.begin() + 17, tree.stepRates.size(), tree.stepRates.begin());
    requireSound(tree, file);
    if (!sameContent(tree.mesh(), mesh)) {
        fail("belongs to another mesh of the same hash", file);
    }
    return tree;
}

}  // namespace grapeshot
