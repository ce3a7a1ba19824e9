// Linked with Bullet.
extern "C" int fallingMesh(int argc, char** argv);

int main(int argc, char** argv) {
    return fallingMesh(argc, argv);
}
