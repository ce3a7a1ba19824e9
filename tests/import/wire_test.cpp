// The message of the loading process: there and back, and any bytes at all.
#include <import/detail/wire.hpp>

#include <gtest/gtest.h>
#include <support/poses.hpp>

namespace grapeshot::import::detail {
namespace {

scenes::Mesh someMesh(test::Random& random) {
    scenes::Mesh mesh;
    for (int v = 0; v < 5; ++v) {
        mesh.vertices.push_back(random.direction());
    }
    mesh.triangles = {{0, 1, 2}, {2, 3, 4}, {4, 0, 1}};
    return mesh;
}

TEST(Wire, CarriesAMesh) {
    test::Random random(1);
    const scenes::Mesh mesh = someMesh(random);
    const auto back = decode(encode(mesh));
    ASSERT_TRUE(std::holds_alternative<scenes::Mesh>(back));
    EXPECT_EQ(std::get<scenes::Mesh>(back).vertices, mesh.vertices);
    EXPECT_EQ(std::get<scenes::Mesh>(back).triangles, mesh.triangles);
    EXPECT_EQ(encode(mesh).size(), wireSize(5, 3));
}

TEST(Wire, CarriesAnErrorWithoutControlCharacters) {
    const auto back = decode(encode(WireError{Fault::emptyMesh, "a\x1b[31mb\nc"}));
    ASSERT_TRUE(std::holds_alternative<WireError>(back));
    EXPECT_EQ(std::get<WireError>(back).fault, Fault::emptyMesh);
    EXPECT_EQ(std::get<WireError>(back).text, "a [31mb c");
    const auto cut = decode(encode(WireError{Fault::badFile, std::string(100'000, 'x')}));
    EXPECT_EQ(std::get<WireError>(cut).text, std::string(wireTextLimit, 'x'));
}

// Under the sanitizers this proves that nothing is read beyond the end; here, that no answer is invented.
TEST(Wire, RefusesEveryPrefixAndAnyDamageToTheCounts) {
    test::Random random(2);
    const std::vector<std::byte> good = encode(someMesh(random));
    for (std::size_t size = 0; size < good.size(); ++size) {
        const std::vector<std::byte> prefix(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_TRUE(std::holds_alternative<WireError>(decode(prefix))) << size;
    }
    for (std::size_t at = 0; at < 24; ++at) {
        for (int bit = 0; bit < 8; ++bit) {
            std::vector<std::byte> bad = good;
            bad[at] ^= std::byte{1} << bit;
            EXPECT_TRUE(std::holds_alternative<WireError>(decode(bad))) << at << " " << bit;
        }
    }
}

TEST(Wire, NeverGivesAnIndexOutOfRange) {
    test::Random random(3);
    const std::vector<std::byte> good = encode(someMesh(random));
    int meshes = 0;
    int errors = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        std::vector<std::byte> bad = good;
        bad[24 + random.bits() % (bad.size() - 24)] = static_cast<std::byte>(random.bits());
        const auto back = decode(bad);
        if (const auto* mesh = std::get_if<scenes::Mesh>(&back)) {
            ++meshes;
            for (const Triangle& triangle : mesh->triangles) {
                for (const std::uint32_t index : triangle) {
                    ASSERT_LT(index, mesh->vertices.size());
                }
            }
        } else {
            ++errors;
        }
    }
    EXPECT_GT(meshes, 1000);
    EXPECT_GT(errors, 1000);
}

}  // namespace
}  // namespace grapeshot::import::detail
