// A widget in a notebook: the alphas of the selected walker go to Python and come from there.
import { openViewer } from "./viewer.js";

export default {
  render({ model, el }) {
    el.innerHTML = model.get("_markup"); // viewer.html as it is; what users wrote is in the contents
    const viewer = openViewer(el.querySelector(".eigenwalker"), model.get("_contents"));
    const take = () => (viewer.alphas = model.get("alphas"));
    viewer.onAlphas = (alphas) => {
      model.set("alphas", alphas);
      model.save_changes();
    };
    model.on("change:alphas", take);
    take();
    return () => {
      model.off("change:alphas", take);
      viewer.close();
    };
  },
};
