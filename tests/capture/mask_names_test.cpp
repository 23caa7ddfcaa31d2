// Which mask belongs to which photograph.
#include "capture/mask_names.h"

#include "capture_fixture.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

class MaskNamesTest : public FolderTest {
protected:
    MaskNamesTest() { fs::create_directories(masks_); }
    MaskNames match(const std::vector<std::string>& names) { return match_masks(masks_, images_, names); }
    std::string refused(const std::vector<std::string>& names) {
        return complaint([&] { match(names); });
    }
    void put(const std::vector<std::string>& masks) {
        for (const std::string& mask : masks) write_bytes(masks_ / mask, "mask");
    }
    /// The only masks there are, in the photographs' order.
    void expect_taken(const std::vector<std::string>& names, const std::vector<std::string>& masks,
                      const std::string& habit) {
        SCOPED_TRACE(habit);
        fs::remove_all(masks_);
        put(masks);
        const MaskNames found = match(names);
        ASSERT_EQ(found.files.size(), masks.size());
        for (size_t i = 0; i < masks.size(); ++i) EXPECT_EQ(found.files[i], masks_ / masks[i]);
        EXPECT_EQ(found.remark, "masks are named " + habit + ": '" + names[0] + "' has " + masks[0]);
        EXPECT_TRUE(found.notes.empty()) << found.notes[0];
    }
    fs::path images_ = root_ / "images", masks_ = root_ / "masks";
};

TEST_F(MaskNamesTest, EveryHabit) {
    expect_taken({"a.jpg", "b.c.JPG"}, {"a.png", "b.c.png"}, "NAME.png");
    expect_taken({"a.jpg", "b.c.JPG"}, {"a.jpg.png", "b.c.JPG.png"}, "NAME.EXT.png");
    expect_taken({"a.jpg", "b.c.JPG"}, {"a_mask.png", "b.c_mask.png"}, "NAME_mask.png");
    expect_taken({"a.jpg", "b.c.JPG"}, {"mask_a.png", "mask_b.c.png"}, "mask_NAME.png");
    expect_taken({"a.jpg", "b.c.JPG"}, {"a.mask.png", "b.c.mask.png"}, "NAME.mask.png");
    expect_taken({"a.jpg", "b.c.JPG"}, {"a.jpg.mask.png", "b.c.JPG.mask.png"}, "NAME.EXT.mask.png");
    expect_taken({"a.png", "b.c.png"}, {"a.jpg", "b.c.jpg"}, "NAME.jpg");
    expect_taken({"a.jpg", "b.jpg"}, {"a.jpg.tif", "b.jpg.tif"}, "NAME.EXT.tif");
    expect_taken({"x/a.jpg", "y/a.jpg"}, {"x/a.png", "y/a.png"}, "NAME.png");
    // "ü" composed and decomposed
    expect_taken({"M\u00fcnze.jpg", "b.jpg"}, {"Mu\u0308nze.png", "b.png"}, "NAME.png");
    expect_taken({"x/a.jpg", "y/b.jpg"}, {"a_mask.png", "b_mask.png"}, "NAME_mask.png, without subfolders");
    expect_taken({"x/a.jpg", "y/b.jpg"}, {"a.jpg.png", "b.jpg.png"}, "NAME.EXT.png, without subfolders");
}

TEST_F(MaskNamesTest, LetterCaseOfEndingsDoesNotMatter) {
    expect_taken({"a.jpg", "b.JPG"}, {"a.PNG", "b.Png"}, "NAME.png");
    expect_taken({"a.jpg", "b.JPG"}, {"a.JPG.png", "b.jpg.PNG"}, "NAME.EXT.png");
    fs::remove_all(masks_);
    put({"A.png"});
    expect_in(
        "no mask for any image: expected, for image 'a.jpg', a.png, a.jpg.png, a_mask.png, a.mask.png or mask_a.png, "
        "or such names of JPEG or TIFF files",
        refused({"a.jpg"}));
}

TEST_F(MaskNamesTest, HiddenFilesAndDrawingsOfMasksAreNone) {
    put({"a.png", "._a.png", "a.jpg", "b.png", ".b.png"});
    const MaskNames found = match({"a.tif", "b.tif"});
    EXPECT_EQ(found.files, (std::vector<fs::path>{masks_ / "a.png", masks_ / "b.png"}));
    EXPECT_TRUE(found.notes.empty());
}

TEST_F(MaskNamesTest, TheHabitOfMostIsTakenAndOthersAreNamed) {
    put({"a_mask.png", "b_mask.png", "a.png"});
    const MaskNames found = match({"a.jpg", "b.jpg"});
    EXPECT_EQ(found.files, (std::vector<fs::path>{masks_ / "a_mask.png", masks_ / "b_mask.png"}));
    ASSERT_EQ(found.notes.size(), 1u);
    expect_in("1 masks that are named NAME.png are left aside, such as a.png", found.notes[0]);
    put({"b.png"});  // as many of either: the plainer one
    EXPECT_EQ(match({"a.jpg", "b.jpg"}).files[0], masks_ / "a.png");
    expect_in("2 masks that are named NAME_mask.png", match({"a.jpg", "b.jpg"}).notes.at(0));
}

TEST_F(MaskNamesTest, WhatIsMissingOrAmbiguousIsNamed) {
    put({"a.png", "c.png"});
    expect_in("no mask for image 'b.jpg' (2 of 4 images have none): expected b.png, as 'a.jpg' has a.png",
              refused({"a.jpg", "b.jpg", "c.jpg", "d.jpg"}));
    put({"mask_b.png"});
    expect_in("; mask_b.png is named otherwise: name all alike", refused({"a.jpg", "b.jpg", "c.jpg"}));
    put({"a.PNG"});
    expect_in("may both be the mask of image 'a.jpg': take one away", refused({"a.jpg", "c.jpg"}));
    expect_in("may be the mask of image 'c.jpg' or of 'c.tif': name the masks NAME.EXT.png",
              refused({"c.jpg", "c.tif"}));
    expect_in("c.png: may be the mask of image 'x/c.jpg' or of 'y/c.jpg': name the masks as the images, in subfolders",
              refused({"x/c.jpg", "y/c.jpg"}));
}

TEST_F(MaskNamesTest, APhotographIsNotItsOwnMask) {
    images_ = masks_;
    put({"a.png", "b.png"});
    expect_in("no mask for any image", refused({"a.png", "b.png"}));
    put({"a_mask.png", "b_mask.png"});
    const MaskNames found = match({"a.png", "b.png"});
    EXPECT_EQ(found.files[1], masks_ / "b_mask.png");
    EXPECT_TRUE(found.notes.empty());
}

}  // namespace
}  // namespace radiafit
