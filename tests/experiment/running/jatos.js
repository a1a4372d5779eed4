// What stands in for jatos.js in tests: a server that lives in the browser's storage, so that it survives a reload.
(() => {
  const get = (name, otherwise = null) => JSON.parse(localStorage.getItem(`server ${name}`)) ?? otherwise;
  const put = (name, value) => localStorage.setItem(`server ${name}`, JSON.stringify(value));
  const run = get("run", 101);
  const arrives = (action) =>
    new Promise((resolve, reject) => {
      const deliver = () => {
        if (get("down", false) || action() === "refused") reject("failed");
        else resolve();
      };
      setTimeout(deliver, get("delay", 10));
    });

  window.jatos = {
    studyResultId: run,
    onLoad(callback) {
      const load = () => {
        jatos.studySessionData = get(`session ${run}`, {});
        jatos.urlQueryParameters = Object.fromEntries(new URL(location).searchParams);
        callback();
      };
      setTimeout(load, 10);
    },
    appendResultData: (text) => arrives(() => put(`results ${run}`, get(`results ${run}`, "") + text)),
    setStudySessionData(data) {
      jatos.studySessionData = data;
      const sent = structuredClone(data);
      return arrives(() => put(`session ${run}`, sent));
    },
    endStudy: () => put(`ended ${run}`, true),
    batchSession: {
      defined: (path) => path.slice(1) in get("batch", {}),
      find: (path) => get("batch", {})[path.slice(1)],
      add: (path, value) =>
        arrives(() => {
          const rival = get("rival"); // another run, which changes the batch session a moment before
          if (rival) {
            put("batch", { ...get("batch", {}), [rival]: "999" });
            put("rival", null);
            return "refused"; // for the batch session has another version now
          }
          return put("batch", { ...get("batch", {}), [path.slice(1)]: value });
        }),
    },
  };
})();
