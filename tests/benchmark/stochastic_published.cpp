#include "stochastic_published.hpp"

#include <exception>
#include <fstream>
#include <sstream>

#include <grapeshot/core/error.hpp>

namespace grapeshot::bench {

std::vector<PublishedRecall> readPublishedRecall(const std::string& file) {
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line) || line != "method,step,found_pct") {
        throw Error(Fault::badFile, "no table of collisions found", file);
    }
    std::vector<PublishedRecall> rows;
    for (int number = 2; std::getline(stream, line); ++number) {
        std::istringstream cells(line);
        std::string method;
        std::string step;
        std::string found;
        std::getline(cells, method, ',');
        std::getline(cells, step, ',');
        std::getline(cells, found, ',');
        if (rows.empty() || rows.back().method != method) {
            rows.push_back({method, {}, {}});
        }
        try {
            rows.back().steps.push_back(std::stoi(step));
            rows.back().foundPercent.push_back(std::stod(found));
        } catch (const std::exception&) {
            throw Error(Fault::badFile, "'" + line + "' has no step and share", file + ":" + std::to_string(number));
        }
    }
    return rows;
}

}  // namespace grapeshot::bench
