#include "mesh/assimp_import.h"

#include <cmath>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

namespace
{

constexpr unsigned nodes_deep_max = 256;

/* Thrown where a report has the message already. */
struct failure {
    sonject_status status;
};

/* The file's bytes, to be read from. */
class memory_stream : public Assimp::IOStream
{
  public:
    memory_stream(const char *bytes, size_t count) : bytes_(bytes), count_(count)
    {
    }

    size_t Read(void *buffer, size_t size, size_t count) override
    {
        const size_t left = size > 0 ? (count_ - at_) / size : 0;
        const size_t taken = count < left ? count : left;
        if (taken > 0)
            std::memcpy(buffer, bytes_ + at_, taken * size);
        at_ += taken * size;
        return taken;
    }

    size_t Write(const void *, size_t, size_t) override
    {
        return 0;
    }

    aiReturn Seek(size_t offset, aiOrigin origin) override
    {
        const size_t start = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : count_;
        if (offset > count_ - start)
            return aiReturn_FAILURE;
        at_ = start + offset;
        return aiReturn_SUCCESS;
    }

    size_t Tell() const override
    {
        return at_;
    }

    size_t FileSize() const override
    {
        return count_;
    }

    void Flush() override
    {
    }

  private:
    const char *bytes_;
    size_t count_, at_ = 0;
};

/* A file system that holds one file, so that no file can make others be read. */
class one_file : public Assimp::IOSystem
{
  public:
    one_file(const char *path, const char *bytes, size_t count)
        : path_(path), bytes_(bytes), count_(count)
    {
    }

    bool Exists(const char *path) const override
    {
        return path_ == path;
    }

    char getOsSeparator() const override
    {
        return '/';
    }

    Assimp::IOStream *Open(const char *path, const char *mode) override
    {
        return Exists(path) && mode[0] == 'r' ? new memory_stream(bytes_, count_) : nullptr;
    }

    void Close(Assimp::IOStream *stream) override
    {
        delete stream;
    }

  private:
    const std::string path_;
    const char *bytes_;
    size_t count_;
};

/* Where a node's numbers lie: three rows of a turn, a stretch and a shift. */
struct placing {
    double rows[3][4];
};

placing placed(const placing &outer, const aiMatrix4x4 &inner)
{
    const ai_real *const rows[3] = {inner[0], inner[1], inner[2]};
    placing both;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            both.rows[i][j] = j == 3 ? outer.rows[i][3] : 0.0;
            for (int k = 0; k < 3; k++)
                both.rows[i][j] += outer.rows[i][k] * double(rows[k][j]);
        }
    return both;
}

bool is_mirror(const placing &place)
{
    const double(*r)[4] = place.rows;
    return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
               r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
               r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]) <
           0.0;
}

class scene_reader
{
  public:
    scene_reader(struct report *report, const char *path, struct mesh_soup *soup)
        : report_(report), path_(path), soup_(soup)
    {
    }

    void add_nodes(const aiScene &scene, const aiNode &node, const placing &place, unsigned depth)
    {
        if (depth > nodes_deep_max)
            throw failure{report_failure(report_, SONJECT_ERROR_INPUT,
                                         "%s: has nodes within nodes more than %u deep; flatten it",
                                         path_, nodes_deep_max)};
        for (unsigned i = 0; i < node.mNumMeshes; i++)
            if (node.mMeshes[i] < scene.mNumMeshes)
                add_mesh(*scene.mMeshes[node.mMeshes[i]], place);
        for (unsigned i = 0; i < node.mNumChildren; i++)
            add_nodes(scene, *node.mChildren[i], placed(place, node.mChildren[i]->mTransformation),
                      depth + 1);
    }

  private:
    void add_vertex(const aiVector3D &vertex, const placing &place)
    {
        double position[3];
        for (int i = 0; i < 3; i++) {
            const double *row = place.rows[i];
            position[i] = row[0] * double(vertex.x) + row[1] * double(vertex.y) +
                          row[2] * double(vertex.z) + row[3];
            if (!std::isfinite(position[i]))
                throw failure{report_failure(
                    report_, SONJECT_ERROR_INPUT,
                    "%s: a coordinate is not a finite number; export the mesh again", path_)};
        }
        if (!mesh_soup_add_vertex(soup_, position))
            throw failure{mesh_soup_failure(report_, path_, soup_)};
    }

    /* Points and lines are passed over. */
    void add_mesh(const aiMesh &mesh, const placing &place)
    {
        const size_t first = soup_->vertices;
        const bool is_turned = is_mirror(place);
        for (unsigned i = 0; i < mesh.mNumVertices; i++)
            add_vertex(mesh.mVertices[i], place);
        for (unsigned i = 0; i < mesh.mNumFaces; i++) {
            const aiFace &face = mesh.mFaces[i];
            uint32_t corners[3];
            if (face.mNumIndices != 3)
                continue;
            for (int k = 0; k < 3; k++) {
                const unsigned number = face.mIndices[is_turned ? 2 - k : k];
                if (number >= mesh.mNumVertices)
                    throw failure{report_failure(report_, SONJECT_ERROR_INPUT,
                                                 "%s: a face has vertex number %u of %u", path_,
                                                 number, mesh.mNumVertices)};
                corners[k] = uint32_t(first + number);
            }
            if (!mesh_soup_add_triangle(soup_, corners[0], corners[1], corners[2]))
                throw failure{mesh_soup_failure(report_, path_, soup_)};
        }
    }

    struct report *report_;
    const char *path_;
    struct mesh_soup *soup_;
};

void import(struct report *report, const char *path, const char *bytes, size_t count,
            struct mesh_soup *soup)
{
    /* a name of its own: the path may be of any length and form */
    const char *extension = std::strrchr(path, '.');
    const std::string name = std::string("mesh") + (extension ? extension : "");
    Assimp::Importer importer;
    importer.SetIOHandler(new one_file(name.c_str(), bytes, count));
    const aiScene *scene =
        importer.ReadFile(name, aiProcess_Triangulate | aiProcess_ValidateDataStructure);
    if (!scene || !scene->mRootNode || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE)) {
        const char *reason = importer.GetErrorString();
        throw failure{report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path,
                                     *reason ? reason : "holds no mesh that can be read")};
    }
    const placing own = {{{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}}};
    scene_reader(report, path, soup)
        .add_nodes(*scene, *scene->mRootNode, placed(own, scene->mRootNode->mTransformation), 0);
}

} // namespace

sonject_status assimp_import(struct report *report, const char *path, const char *bytes,
                             size_t count, struct mesh_soup *soup)
{
    try {
        import(report, path, bytes, count, soup);
        return SONJECT_OK;
    } catch (const failure &known) {
        return known.status;
    } catch (const std::bad_alloc &) {
        return report_out_of_memory(report, path);
    } catch (const std::exception &unforeseen) {
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, unforeseen.what());
    } catch (...) {
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be read", path);
    }
}
