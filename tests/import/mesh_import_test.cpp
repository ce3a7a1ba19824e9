// Good files in four formats, bad files of every kind, and loaders that crash, hang, swallow memory or lie.
#include <import/mesh_import.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <numbers>
#include <set>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>

namespace grapeshot::import {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

scenes::Mesh tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

class MeshImport : public ::testing::Test {
  protected:
    MeshImport() : m_directory(fs::temp_directory_path() / ("grapeshot import " + std::to_string(getpid()))) {
        fs::create_directories(m_directory);
    }
    ~MeshImport() override { fs::remove_all(m_directory); }

    fs::path write(const std::string& fileName, const std::string& content) const {
        fs::path file = m_directory / fileName;
        std::ofstream(file, std::ios::binary) << content;
        return file;
    }

    /// A program to take the loader's place.
    ImportLimits loader(const std::string& script) const {
        ImportLimits limits;
        limits.helper = write("loader", "#!/bin/sh\n" + script + "\n");
        fs::permissions(limits.helper, fs::perms::owner_all);
        return limits;
    }

    static void expectFault(Fault fault, const std::string& words, const fs::path& file,
                            const ImportLimits& limits = {}) {
        try {
            const scenes::Mesh mesh = importMesh(file, limits);
            ADD_FAILURE() << file << " was loaded: " << mesh.triangles.size() << " triangles";
        } catch (const Error& error) {
            EXPECT_EQ(name(error.fault()), name(fault)) << error.what();
            EXPECT_THAT(error.what(), HasSubstr(words));
            EXPECT_THAT(error.place(), HasSubstr(file.filename().string()));
        }
    }

  private:
    fs::path m_directory;
};

std::string asOff(const scenes::Mesh& mesh) {
    std::ostringstream out;
    out << "OFF\n# a comment\n" << mesh.vertices.size() << " " << mesh.triangles.size() << " 0\n";
    for (const auto& v : mesh.vertices) {
        out << v.x() << " " << v.y() << " " << v.z() << "\n";
    }
    for (const auto& t : mesh.triangles) {
        out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    }
    return out.str();
}

std::string asObj(const scenes::Mesh& mesh) {
    std::ostringstream out;
    for (const auto& v : mesh.vertices) {
        out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
    }
    for (const auto& t : mesh.triangles) {
        out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    }
    return out.str();
}

std::string asBinaryStl(const scenes::Mesh& mesh) {
    std::string out(80, 'x');
    const auto put = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        put(std::array<float, 3>{0, 0, 1});
        for (const std::uint32_t corner : t) {
            put(mesh.vertices[corner]);
        }
        put(std::uint16_t{0});
    }
    return out;
}

std::string plyHeader(const std::string& format, std::uint64_t vertices, std::uint64_t faces) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string asBinaryPly(const scenes::Mesh& mesh) {
    std::string out = plyHeader("binary_little_endian", mesh.vertices.size(), mesh.triangles.size());
    const auto put = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const auto& v : mesh.vertices) {
        put(v);
    }
    for (const auto& t : mesh.triangles) {
        put(std::uint8_t{3});
        put(t);
    }
    return out;
}

void expectTetrahedron(const fs::path& file, float scale = 1.0F) {
    const MeshReport report = inspect(importMesh(file).view());
    EXPECT_EQ(report.triangles, 4U) << file;
    EXPECT_EQ(report.distinctVertices, 4U) << file;
    EXPECT_TRUE(report.closed) << file;
    EXPECT_NEAR(report.volume, scale * scale * scale, 1e-5) << file;  // 1 * 2 * 3 / 6, outside out
}

TEST_F(MeshImport, ReadsTheSameMeshFromEveryFormat) {
    expectTetrahedron(write("a.off", asOff(tetrahedron())));
    expectTetrahedron(write("a.obj", asObj(tetrahedron())));
    expectTetrahedron(write("a.stl", asBinaryStl(tetrahedron())));
    expectTetrahedron(write("a.ply", asBinaryPly(tetrahedron())));
    expectTetrahedron(write("with a space.off", asOff(tetrahedron())));
}

TEST_F(MeshImport, CutsPolygonsAndLeavesLinesOut) {
    const std::string cube =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
    for (const char* line : {"", "l 1 7\n"}) {
        const MeshReport report = inspect(importMesh(write("cube.obj", cube + line)).view());
        EXPECT_EQ(report.triangles, 12U);
        EXPECT_NEAR(report.volume, 1, 1e-6);
    }
}

// Collada is the smallest text format with a tree of nodes. The second instance mirrors, the third is nested.
TEST_F(MeshImport, PutsNodesWhereTheyBelongAndKeepsTheOutsideOut) {
    const std::string geometry =
        R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="pa" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices><triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node id="a"><translate>10 0 0</translate><instance_geometry url="#g"/></node>
<node id="b"><scale>-1 1 1</scale><instance_geometry url="#g"/></node>
<node id="c"><translate>0 20 0</translate><node id="d"><scale>2 2 2</scale><instance_geometry url="#g"/></node></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
    const MeshReport report = inspect(importMesh(write("nodes.dae", geometry)).view());
    EXPECT_EQ(report.triangles, 12U);
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(report.volume, 1 + 1 + 8, 1e-4);
    EXPECT_NEAR(report.lower.x(), -1, 1e-6);
    EXPECT_NEAR(report.upper.x(), 11, 1e-6);
    EXPECT_NEAR(report.upper.y(), 24, 1e-6);
}

TEST_F(MeshImport, LeavesNotANumberToTheMeshReport) {
    const MeshReport report =
        inspect(importMesh(write("nan.off", "OFF\n4 2 0\nnan 0 0\n1 0 0\n0 1 0\n0 0 inf\n3 0 1 2\n3 1 2 3\n")).view());
    EXPECT_EQ(report.notFiniteVertices, 2U);
}

TEST_F(MeshImport, NamesIndicesOutOfRange) {
    const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
    for (const std::string index : {"3", "9", "4294967295", "-1"}) {
        expectFault(Fault::indexOutOfRange, "", write("range.off", "OFF\n3 1 0\n" + corners + "3 0 1 " + index + "\n"));
        expectFault(Fault::indexOutOfRange, "",
                    write("range.ply", plyHeader("ascii", 3, 1) + corners + "3 0 1 " + index + "\n"));
    }
    // This loader stops by itself, with its own words.
    expectFault(Fault::indexOutOfRange, "out of range", write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"));
}

TEST_F(MeshImport, RefusesHeadersThatClaimMoreThanTheFileHolds) {
    const std::string huge = std::to_string(std::uint64_t{1} << 40U);
    expectFault(Fault::badFile, huge, write("huge.off", "OFF\n" + huge + " 6 0\n0 0 0\n"));
    expectFault(Fault::badFile, huge, write("huge.off", "OFF " + huge + " 6 0\n0 0 0\n"));
    expectFault(Fault::badFile, huge, write("faces.off", "OFF\n3 " + huge + " 0\n0 0 0\n"));
    expectFault(Fault::badFile, "is no number", write("wrap.off", "OFF\n99999999999999999999999 1 0\n0 0 0\n"));
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        expectFault(Fault::badFile, huge, write("huge.ply", plyHeader(format, std::uint64_t{1} << 40U, 1)));
        expectFault(Fault::badFile, huge,
                    write("huge.ply", plyHeader(format, 1, std::uint64_t{1} << 40U) + "0.0 0.0 0.0\n"));
    }
    std::string stl = asBinaryStl(tetrahedron());
    stl[83] = '\x7f';
    expectFault(Fault::badFile, "2130706436 triangles", write("huge.stl", stl));
}

// Every prefix, until the next line end or so, of a good file: an error with a name, or (if only the tail of a line
// without meaning is gone) the good mesh. Never another mesh.
TEST_F(MeshImport, RefusesFilesThatWereCutOff) {
    struct Case {
        const char* file;
        std::string content;
    };
    std::size_t refused = 0;
    for (const auto& [file, content] :
         {Case{"cut.off", asOff(tetrahedron())}, Case{"cut.ply", asBinaryPly(tetrahedron())},
          Case{"cut.stl", asBinaryStl(tetrahedron())}}) {
        for (std::size_t bytes = 0; bytes + 1 < content.size(); bytes += 13) {
            try {
                EXPECT_EQ(importMesh(write(file, content.substr(0, bytes))).triangles.size(), 4U) << file << bytes;
            } catch (const Error&) {
                ++refused;
            }
        }
    }
    EXPECT_GT(refused, 30U);
    const std::string ascii = plyHeader("ascii", 3, 2) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    expectFault(Fault::badFile, "cut off", write("cut.ply", ascii));
}

TEST_F(MeshImport, RefusesWhatIsNoMesh) {
    expectFault(Fault::badFile, "No such file", "/nonexistent/a.obj");
    expectFault(Fault::badFile, "not a regular file", write("x", "").parent_path());
    expectFault(Fault::emptyMesh, "empty", write("empty.off", ""));
    expectFault(Fault::badFile, "", write("empty.obj", ""));
    expectFault(Fault::badFile, "not an OFF", write("text.off", "This is not a mesh.\n"));
    expectFault(Fault::badFile, "", write("text.xyzzy", "This is not a mesh.\n"));
    expectFault(Fault::emptyMesh, "no ", write("lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"));
    ImportLimits limits;
    limits.maxFileBytes = 50;
    expectFault(Fault::limitExceeded, "the limit is 50", write("long.off", asOff(tetrahedron())), limits);
}

TEST_F(MeshImport, KeepsToTheLimitsOnCounts) {
    ImportLimits limits;
    limits.maxVertices = 3;
    expectFault(Fault::limitExceeded, "3 vertices", write("a.off", asOff(tetrahedron())), limits);
    limits.maxVertices = 4;
    limits.maxTriangles = 3;
    expectFault(Fault::limitExceeded, "3 triangles", write("a.off", asOff(tetrahedron())), limits);
    limits.maxTriangles = 4;
    EXPECT_EQ(importMesh(write("a.off", asOff(tetrahedron())), limits).triangles.size(), 4U);
}

TEST_F(MeshImport, KeepsToTheLimitOnMemory) {
    // 200,000 vertices take several times their 6 MB in the loader.
    std::string text = "OFF\n200000 1 0\n";
    for (int i = 0; i < 200000; ++i) {
        text += std::to_string(i) + ".25 1.5 2.5\n";
    }
    text += "3 0 1 2\n";
    const fs::path file = write("large.off", text);
    EXPECT_EQ(importMesh(file).triangles.size(), 1U);
    // How much the loader takes before the file is a matter of its libraries: go up from too little.
    bool tooLittle = false;
    bool enough = false;
    for (std::size_t megabytes = 24; megabytes <= 2048 && !enough; megabytes += megabytes / 4) {
        ImportLimits limits;
        limits.maxMemory = megabytes << 20U;
        try {
            enough = importMesh(file, limits).triangles.size() == 1;
        } catch (const Error& error) {
            tooLittle = tooLittle || error.fault() == Fault::limitExceeded;
        }
    }
    EXPECT_TRUE(tooLittle) << "no size of memory was too small and said so";
    EXPECT_TRUE(enough);
}

TEST_F(MeshImport, SurvivesALoaderThatCrashes) {
    const fs::path file = write("a.off", asOff(tetrahedron()));
    expectFault(Fault::badFile, "signal 11", file, loader("kill -SEGV $$"));
    expectFault(Fault::badFile, "signal 6", file, loader("kill -ABRT $$"));
    expectFault(Fault::badFile, "signal 9", file, loader("kill -KILL $$"));
    expectFault(Fault::badFile, "exit code 3", file, loader("exit 3"));
}

TEST_F(MeshImport, EndsALoaderThatHangs) {
    const fs::path file = write("a.off", asOff(tetrahedron()));
    ImportLimits sleeping = loader("exec sleep 1000");
    sleeping.wallTime = std::chrono::milliseconds(200);
    expectFault(Fault::limitExceeded, "longer than 0.2 s", file, sleeping);

    ImportLimits closed = loader("exec >&- ; exec sleep 1000");  // the answer has ended, the process has not
    closed.wallTime = std::chrono::milliseconds(200);
    expectFault(Fault::limitExceeded, "longer than 0.2 s", file, closed);

    ImportLimits spinning = loader("while :; do :; done");
    spinning.cpuTime = std::chrono::seconds(1);
    expectFault(Fault::limitExceeded, "1.0 s of processor time", file, spinning);
}

TEST_F(MeshImport, BelievesNothingALoaderSays) {
    const fs::path file = write("a.off", asOff(tetrahedron()));
    expectFault(Fault::badFile, "not a message", file, loader("exit 0"));
    expectFault(Fault::badFile, "not a message", file, loader("echo Hello, I am a mesh."));
    ImportLimits flood = loader("exec cat /dev/zero");
    flood.maxVertices = 1000;
    flood.maxTriangles = 1000;
    expectFault(Fault::limitExceeded, "1000 vertices", file, flood);
    expectFault(
        Fault::badFile, "counts and size disagree", file,
        loader(R"(printf 'GSI1\001\000\000\000\000\000\000\000\000\001\000\000\004\000\000\000\000\000\000\000')"));
}

TEST_F(MeshImport, SaysThatThereIsNoLoader) {
    ImportLimits limits;
    limits.helper = "/nonexistent/loader";
    try {
        (void)importMesh(write("a.off", asOff(tetrahedron())), limits);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.fault(), Fault::badSetting);
        EXPECT_EQ(error.place(), "/nonexistent/loader");
    }
    limits.helper = write("notaprogram",
                          "\x7f"
                          "ELF nonsense");
    fs::permissions(limits.helper, fs::perms::owner_all);
    EXPECT_THROW((void)importMesh(write("a.off", asOff(tetrahedron())), limits), Error);
}

// Valid and invalid files of assimp's own collection, where it is installed. Some crash or hang assimp 5.2 under other
// settings. Whatever it does, we get a mesh with valid indices or an Error.
TEST_F(MeshImport, ComesThroughAssimpsOwnTestFiles) {
    const fs::path models = "/usr/share/assimp/models";
    if (!fs::exists(models)) {
        GTEST_SKIP() << "assimp-testmodels is not installed";
    }
    ImportLimits limits;
    limits.wallTime = std::chrono::seconds(20);
    expectFault(Fault::badFile, "353535235358", models / "invalid/OutOfMemory.off", limits);
    expectFault(Fault::badFile, "lost a part", models / "RAW/WithTexture.raw", limits);
    std::size_t loaded = 0;
    std::size_t refused = 0;
    for (const char* room : {"invalid", "OFF", "STL", "PLY", "RAW"}) {
        std::set<fs::path> files;  // in one order everywhere
        for (const fs::directory_entry& entry : fs::directory_iterator(models / room)) {
            if (entry.is_regular_file()) {
                files.insert(entry.path());
            }
        }
        for (const fs::path& file : files) {
            try {
                loaded += inspect(importMesh(file, limits).view()).indicesOutOfRange == 0 ? 1U : 0U;
            } catch (const Error&) {
                ++refused;
            }
        }
    }
    EXPECT_GT(loaded, 15U);
    EXPECT_GT(refused, 10U);
}

}  // namespace
}  // namespace grapeshot::import
