#include "deformation.hpp"

#include <cmath>

namespace grapeshot::bench {

std::vector<Eigen::Vector3f> twisted(std::span<const Eigen::Vector3f> vertices) {
    Eigen::Vector3f lower = vertices.front();
    Eigen::Vector3f upper = vertices.front();
    for (const Eigen::Vector3f& vertex : vertices) {
        lower = lower.cwiseMin(vertex);
        upper = upper.cwiseMax(vertex);
    }
    const Eigen::Vector3f middle = 0.5F * (lower + upper);
    int along = 0;
    const float length = (upper - lower).maxCoeff(&along);
    const int first = (along + 1) % 3;
    const int second = (along + 2) % 3;
    std::vector<Eigen::Vector3f> moved;
    moved.reserve(vertices.size());
    for (const Eigen::Vector3f& vertex : vertices) {
        const float place = (vertex[along] - middle[along]) / length;  // -0.5..0.5, and the angle in rad
        const float x = vertex[first] - middle[first];
        const float y = vertex[second] - middle[second];
        Eigen::Vector3f result = vertex;
        result[first] = middle[first] + x * std::cos(place) - y * std::sin(place) + 0.4F * length * place * place;
        result[second] = middle[second] + x * std::sin(place) + y * std::cos(place);
        moved.push_back(result);
    }
    return moved;
}

}  // namespace grapeshot::bench
