// `grapeshot-import`: the process in which assimp may crash, hang or run out of memory. Started by importMesh with its
// limits already set; writes one message to standard output.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "detail/scene_reader.hpp"
#include "detail/wire.hpp"

namespace {

using namespace grapeshot::import::detail;

void send(const std::vector<std::byte>& message) {
    for (std::size_t sent = 0; sent < message.size();) {
        const ssize_t now = write(STDOUT_FILENO, message.data() + sent, message.size() - sent);
        if (now < 0 && errno == EINTR) {
            continue;
        }
        if (now <= 0) {
            _exit(1);
        }
        sent += static_cast<std::size_t>(now);
    }
}

// Made beforehand: when it is needed there is no memory to make it.
std::vector<std::byte> outOfMemoryMessage;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

[[noreturn]] void outOfMemory() {
    send(outOfMemoryMessage);
    _exit(0);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fputs("usage: grapeshot-import MAX_VERTICES MAX_TRIANGLES FILE (started by other programs)\n", stderr);
        return 2;
    }
    outOfMemoryMessage = encode(WireError{grapeshot::Fault::limitExceeded, "the loader needs more memory than it may"});
    std::set_new_handler(outOfMemory);
    const std::size_t maxVertices = std::strtoull(argv[1], nullptr, 10);
    const std::size_t maxTriangles = std::strtoull(argv[2], nullptr, 10);
    try {
        const auto result = readScene(argv[3], maxVertices, maxTriangles);
        send(std::visit([](const auto& value) { return encode(value); }, result));
    } catch (const std::exception& error) {
        send(encode(WireError{grapeshot::Fault::badFile, error.what()}));
    }
    // Not through assimp's destructors: the answer is out.
    _exit(0);
}
