// Which file of this machine a name in a calibration or a list means.
#include "capture/image_finder.h"

#include "capture_fixture.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

class ImageFinderTest : public FolderTest {
protected:
    void put(const std::vector<std::string>& files) {
        for (const std::string& file : files) write_bytes(images_ / file, "picture");
    }
    std::string found(const std::string& name) {
        const auto file = finder_.find(name);
        return file ? file->generic_string() : "none";
    }
    fs::path images_ = root_ / "images";
    ImageFinder finder_{images_, root_ / "list.txt"};
};

TEST_F(ImageFinderTest, NamesThatAreFilesAreTakenWithoutAWord) {
    put({"a.jpg", "sub/a.jpg", "A.jpg", "a.png", "b.png"});
    for (const char* name : {"a.jpg", "sub/a.jpg", "A.jpg", "a.png"}) EXPECT_EQ(found(name), name);
    EXPECT_EQ(found("./sub/../sub/a.jpg"), "sub/a.jpg");
    EXPECT_EQ(found("b"), "b.png");  // NeRF's own sets have no endings
    EXPECT_TRUE(finder_.remarks().empty());
    EXPECT_EQ(found("c.jpg"), "none");
    EXPECT_EQ(found("../list.txt.jpg"), "none");
}

TEST_F(ImageFinderTest, PathsOfAnotherMachine) {
    put({"a.jpg", "sub/b.jpg"});
    EXPECT_EQ(found(R"(C:\Users\me\images\a.jpg)"), "a.jpg");
    EXPECT_EQ(found(R"(sub\b.jpg)"), "sub/b.jpg");
    EXPECT_EQ(found("/home/me/sub/b.jpg"), "sub/b.jpg");
    EXPECT_EQ(found(R"(D:\sub\B.JPG)"), "sub/b.jpg");
    const auto remarks = finder_.remarks();
    ASSERT_EQ(remarks.size(), 3u);
    expect_in("names 2 photographs by other folders: 'C:\\Users", remarks[0]);
    expect_in("names 1 photograph in other letters", remarks[1]);
    expect_in("names 1 photograph with backslashes", remarks[2]);
}

TEST_F(ImageFinderTest, LettersThatDifferInCaseOrCompositionAlone) {
    put({"Mu\u0308nze.JPG", "\u00e9t\u00e9/1.png"});
    EXPECT_EQ(found("M\u00fcnze.jpg"), "Mu\u0308nze.JPG");
    EXPECT_EQ(found("M\u00dcNZE.jpg"), "Mu\u0308nze.JPG");
    EXPECT_EQ(found("e\u0301te\u0301/1.png"), "\u00e9t\u00e9/1.png");
    EXPECT_EQ(found("munze.jpg"), "none");
    EXPECT_EQ(found("\xff\xfe.jpg"), "none");  // no UTF-8
}

TEST_F(ImageFinderTest, PhotographsThatWereConverted) {
    put({"1.png", "IMG_2.tif", "shot.3.png", "4.txt", "IMG_2.xmp"});
    EXPECT_EQ(found("1.jpeg"), "1.png");
    EXPECT_EQ(found("/data/img_2.JPG"), "IMG_2.tif");
    EXPECT_EQ(found("shot.3"), "shot.3.png");
    EXPECT_EQ(found("1.CR2"), "1.png");  // a camera's own file
    EXPECT_EQ(found("4.jpg"), "none");   // no photograph
    EXPECT_EQ(found("shot.jpg"), "none");
}

TEST_F(ImageFinderTest, SeveralThatMayBeMeantAreNamed) {
    put({"1.png", "1.jpg", "Shot.png", "SHOT.png", "._2.png", "2.tif"});
    expect_in("may be", complaint([&] { finder_.find("1.tif"); }));
    expect_in("SHOT.png or", complaint([&] { finder_.find("shot.png"); }));
    EXPECT_EQ(found("2.jpg"), "2.tif") << "hidden files are no photographs";
}

}  // namespace
}  // namespace radiafit
