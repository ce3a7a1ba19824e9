#include "text_file.hpp"

#include <fstream>

#include <grapeshot/core/error.hpp>

namespace grapeshot::report {

void writeText(const std::filesystem::path& file, const std::string& text) {
    std::ofstream stream(file);
    stream << text;
    stream.close();
    if (!stream) {
        throw Error(Fault::badFile, "cannot be written", file.string());
    }
}

}  // namespace grapeshot::report
