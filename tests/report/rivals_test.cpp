// Times at equal shares of arrived problems, by hand.
#include "page/rivals.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace radiafit {
using namespace harness;
namespace {

CsvTable csv(const std::string& text) { return CsvTable("rows.csv", text); }

TEST(Rivals, VerticesCountWhenAllThreeProblemsArrive) {
    std::string vertices = "solver,setting,vertex,reached,seconds_to_101\n";
    for (int v = 0; v < 10; ++v) {
        // varpro: all arrive, after 1 to 10 s; ours: one in ten does not; Ceres: slow, and slower
        vertices += "varpro,," + std::to_string(v) + ",3," + std::to_string(1 + v) + "\n";
        vertices += "two-step,sd," + std::to_string(v) + (v == 3 ? ",2,0.5\n" : ",3,0.25\n");
        vertices += "ceres,lbfgs," + std::to_string(v) + ",3,20\n";
        vertices += "ceres,cgnr," + std::to_string(v) + ",3,30\n";
        vertices += "als,," + std::to_string(v) + (v < 4 ? ",3,1\n" : ",0,1\n");
    }
    vertices += "ceres,dense-qr,0,3,0.1\n";  // had time for one vertex alone
    const std::string solvers =
        "solver,setting,precision,together,instructions\nvarpro,,64,3,AVX2\ntwo-step,sd,32,3,AVX2\n"
        "ceres,cgnr,64,1,SSE2\nceres,lbfgs,64,1,SSE2\nals,,64,3,AVX2\nceres,dense-qr,64,1,SSE2\n";
    const std::vector<Rival> rivals = vertex_rivals(csv(vertices), csv(solvers));
    ASSERT_EQ(rivals.size(), 3U) << "als brings fewer than half home, and of Ceres' settings one is shown";
    EXPECT_EQ(rivals[0].solver, "two-step sd");
    EXPECT_EQ(*rivals[0].seconds[0], 0.25);
    EXPECT_EQ(*rivals[0].seconds[1], 0.25);
    EXPECT_FALSE(rivals[0].seconds[2]) << "99 % never arrive";
    EXPECT_EQ(rivals[0].arrived, 0.9);
    EXPECT_EQ(rivals[1].solver, "varpro");
    EXPECT_EQ(*rivals[1].seconds[0], 5);
    EXPECT_EQ(*rivals[1].seconds[1], 9);
    EXPECT_EQ(*rivals[1].seconds[2], 10);
    EXPECT_EQ(rivals[1].precision, "64");
    EXPECT_EQ(rivals[1].together, 3);
    EXPECT_EQ(rivals[2].solver, "ceres lbfgs");
    EXPECT_EQ(rivals[2].problems, 10U);
    EXPECT_THROW(vertex_rivals(csv("solver,setting,vertex,reached,seconds_to_101\na,,0,3,-1\n"), csv(solvers)),
                 UserError);
    EXPECT_THROW(vertex_rivals(csv(vertices), csv("solver,setting\nvarpro,\n")), UserError) << "older rows";
}

TEST(Rivals, TexelsTakeTheQuickestFitThatBringsSoManyHome) {
    const std::vector<Rival> rivals = texel_rivals(
        csv("method,iterations,texels,arrived_share,seconds,precision,together,instructions\n"
            "LM,2,1000,0.6,0.001,32,8,AVX-512\nLM,8,1000,0.95,0.002,32,8,AVX-512\n"
            "LM,50,1000,0.96,0.004,32,8,AVX-512\nCeres,4,1000,0.995,0.5,64,1,SSE2\nsd,100,1000,0.3,1,32,8,AVX2\n"));
    ASSERT_EQ(rivals.size(), 2U);
    EXPECT_EQ(rivals[0].solver, "LM");
    EXPECT_DOUBLE_EQ(*rivals[0].seconds[0], 1e-6);
    EXPECT_DOUBLE_EQ(*rivals[0].seconds[1], 2e-6);
    EXPECT_FALSE(rivals[0].seconds[2]);
    EXPECT_EQ(rivals[0].arrived, 0.96);
    EXPECT_DOUBLE_EQ(*rivals[1].seconds[2], 5e-4);
}

}  // namespace
}  // namespace radiafit
