// A program without Bullet: two boxes, apart and together.
#include <cstdio>

#include <grapeshot/adb/query.hpp>

int main() {
    const std::vector<Eigen::Vector3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::vector<grapeshot::Triangle> triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    const grapeshot::Tree tree = grapeshot::build({vertices, triangles});
    grapeshot::Query query(tree, tree);
    const bool near = query.decide({Eigen::Matrix3f::Identity(), {0.1F, 0.1F, 0.1F}}).collides;
    const bool far = query.decide({Eigen::Matrix3f::Identity(), {5, 0, 0}}).collides;
    std::printf("near %d far %d\n", near, far);
    return near && !far ? 0 : 1;
}
